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
  GaussianDepth sfm;                 ///< [m] before fusion; empty: there is none
  std::vector<cv::Rect> mirrors;     ///< [px] in which nothing is drawn
  double max_relative_sigma = 0.12;  ///< [1] σ / Z of completed depth
  float focal_length = 0.0F;         ///< [px] of the images; 0: not known

  GaussianDepth& depth;                ///< [m] fused: is completed
  cv::Mat_<std::uint8_t>& provenance;  ///< values of Provenance: as `depth`
};

/// Fills the holes of fused depth with what lies between measured depths of one surface (method.md 11):
/// planes in inverse depth through SfM's depths in the hole and the sensor's at its rim, guided by the image;
/// see surfaces.h for how they are drawn, and where not. Shadows of near surfaces lie on the farther one.
///
/// How far a surface is off them is learned on the way (completion_errors.h): holes of the frame before are
/// laid over what the sensor sees now, and completed without it. There SfM's depth is as before it was judged
/// by what agrees with it around, which in real holes it is: factors are rather too large than too small.
class DepthCompletion {
 public:
  /// @return [px] that were completed
  std::uint64_t complete(FrameToComplete frame);

 private:
  void learn(const FrameToComplete& frame);

  CellGrid grid_;
  cv::Mat_<std::uint8_t> grey_;  ///< of cells
  CellLinks links_;
  CellMeans sensor_, sfm_;
  Supports supports_;
  std::vector<std::uint8_t> wanted_;  ///< cells to be drawn
  SurfaceDrawing drawing_;
  CompletionErrors errors_;
  std::vector<std::uint8_t> holes_;  ///< of a frame before, by cells
  int frames_ = 0;
};

}  // namespace rgbd_sfm_fusion
