// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "rgbd_sfm_fusion/geometry/row_points.h"
#include "rgbd_sfm_fusion/image/brightness.h"
#include "rgbd_sfm_fusion/image/inverse_depth.h"
#include "rgbd_sfm_fusion/mapping/semi_dense_map.h"
#include "rgbd_sfm_fusion/mapping/stereo_candidates.h"

namespace rgbd_sfm_fusion {

/// The change from one keyframe to the next.
struct KeyframeChange {
  const GreyImage& from_image;
  const cv::Mat_<float>& to_image;
  cv::Rect seen;  ///< part of `to_image` that the camera has seen
  const InverseDepthWarp& warp;
  Brightness brightness;  ///< of the new keyframe relative to the old one
};

/// Carries a map to a new keyframe (Engel et al. 2013, section 2.3). Each estimate goes to the pixel nearest
/// to its projection, if the brightness there is the same. Where several estimates meet, the nearest surface
/// stays, and of one surface the best estimate. Rounding leaves gaps: a candidate without an estimate takes
/// the estimate whose projection is nearest to it, within a pixel.
class Propagation {
 public:
  /// @param size  of the images
  explicit Propagation(const cv::Size& size);

  /// @param candidates  of the new keyframe; not at its border
  /// @param to          overwritten
  void run(const KeyframeChange& change, const SemiDenseMap& from, const StereoCandidates& candidates,
           const MappingOptions& options, SemiDenseMap& to);

 private:
  void warpAll(const KeyframeChange& change, const SemiDenseMap& from);
  void compareBrightness(const KeyframeChange& change, float max_difference);
  void carryAll(const SemiDenseMap& from, SemiDenseMap& to);
  bool prevails(std::size_t i, std::size_t there, const SemiDenseMap& from) const;
  void fillGaps(const StereoCandidates& candidates, const SemiDenseMap& from, SemiDenseMap& to) const;
  int nearestTo(int pixel, const SemiDenseMap& from) const;

  RowPoints row_;
  // The estimates that are carried, in image order.
  std::vector<int> origins_;  // pixels in the old keyframe
  WarpedPoints warped_;
  std::vector<std::uint8_t> same_;  // whether the projection is in view and of the same brightness; longer
  // Indices of estimates.
  cv::Mat_<int> at_origin_;  // per pixel of the old keyframe; any one for a pixel without an estimate
  cv::Mat_<int> carried_;    // per pixel of the new keyframe, before gaps are filled; -1: none
};

}  // namespace rgbd_sfm_fusion
