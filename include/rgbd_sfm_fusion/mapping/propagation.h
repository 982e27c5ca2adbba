// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
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
/// the estimate whose projection is nearest to it, within a pixel, of those whose neighbour came to a
/// neighbour of the candidate, from the same side.
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
  void placeAll(const SemiDenseMap& from);
  bool prevails(std::size_t i, std::size_t there, const SemiDenseMap& from) const;
  void fillGaps(const StereoCandidates& candidates);
  std::array<int, 8> around() const;
  bool belongsBeside(int estimate, int pixel) const;
  int nearestNeighbour(int pixel) const;
  int indexOf(int origin) const;
  void carryAll(const SemiDenseMap& from, SemiDenseMap& to);

  struct Gap {
    int pixel, estimate;  // an index
  };

  RowPoints row_;
  // The estimates that are carried, in image order.
  std::vector<int> origins_;  // pixels in the old keyframe
  WarpedPoints warped_;
  std::vector<std::uint8_t> same_;  // whether the projection is in view and of the same brightness; longer
  // Per pixel of the new keyframe:
  cv::Mat_<int> carried_;              // index of the estimate that it gets; -1: none
  std::vector<std::uint64_t> beside_;  // the estimate whose projection is nearest, if it is within a pixel
  std::vector<Gap> gaps_;
  std::vector<int> targets_;  // pixels that get an estimate; longer
};

}  // namespace rgbd_sfm_fusion
