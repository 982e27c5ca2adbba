// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "rgbd_sfm_fusion/completion/completion_errors.h"
#include "rgbd_sfm_fusion/completion/surfaces.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// A frame whose holes are to be filled. All images have the same size.
struct FrameToComplete {
  GreyImage grey;
  GaussianDepth sensor;              ///< [m] as measured
  const SfmPoints& sfm;              ///< [m] before fusion
  std::vector<cv::Rect> mirrors;     ///< [px] areas in which nothing is drawn
  double max_relative_sigma = 0.12;  ///< [1] σ / Z of completed depth
  float focal_length = 0.0F;         ///< [px] of the camera; 0: not known
  CommonVariance common_variance;    ///< of SfM's depths; empty: nothing

  GaussianDepth& depth;                ///< [m] fused depth; completed in place
  cv::Mat_<std::uint8_t>& provenance;  ///< values of Provenance; changed with `depth`
};

/// Fills holes of fused depth that lie between measured depths of one surface (method.md 11). Planes in
/// inverse depth go through SfM's depths in the hole and the sensor's depths at its rim, guided by the image.
/// surfaces.h says how planes are drawn, and where not. In the shadow of a near surface, the farther surface
/// is continued.
///
/// How far surfaces are off these planes is learned on the way (completion_errors.h): holes of an earlier
/// frame are laid over depth that the sensor sees now, and completed without that depth.
class DepthCompletion {
 public:
  /// @return [px] number of completed pixels
  std::uint64_t complete(FrameToComplete frame);

 private:
  void learn(const FrameToComplete& frame);

  CellGrid grid_;
  cv::Mat_<std::uint8_t> grey_;  ///< mean brightness of cells
  CellLinks links_;
  CellMeans sensor_, sfm_, withheld_;
  Supports supports_;
  std::vector<std::uint8_t> wanted_;  ///< cells to be drawn
  SurfaceDrawing drawing_;
  CompletionErrors errors_;
  std::vector<std::uint8_t> holes_;  ///< 1: cells that were holes when the completion last learned
  int frames_ = 0;
};

}  // namespace rgbd_sfm_fusion
