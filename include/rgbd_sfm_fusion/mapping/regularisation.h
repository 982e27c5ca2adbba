// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "rgbd_sfm_fusion/mapping/semi_dense_map.h"

namespace rgbd_sfm_fusion {

/// Smoothing over neighbours that agree (Engel et al. 2013, section 2.4), and priors for gaps between them.
class Regulariser {
 public:
  /// A new keyframe: only blocks with candidates are looked at from now on.
  void setCandidates(const StereoCandidates& candidates, const cv::Size& size);

  void apply(const SemiDenseMap& map);

  /// Averages once more, over agreeing neighbours within four pixels. The variance is that of the mean: a
  /// poor estimate among good neighbours is as good as they are.
  /// @param from    estimates of this keyframe, averaged once; 0 and infinity = none
  /// @param result  overwritten
  void smoothWidely(const InverseDepthImage& from, InverseDepthImage& result);

  /// Where the map has an estimate: the weighted mean of the agreeing neighbours within two pixels, with the
  /// pixel's own variance, not a reduced one, since neighbours' errors are alike. Without one, but between
  /// enough neighbours: their mean with their spread, as a prior for a search.
  const InverseDepthImage& smoothed() const { return smoothed_; }

  /// The mean scatter of the agreeing neighbours, since one pixel's few observations say little. Where the
  /// map has an estimate; else meaningless.
  const cv::Mat_<float>& scatter() const { return scatter_; }

  /// Neighbours that agree, where the map has an estimate; else 0.
  const cv::Mat_<std::uint8_t>& support() const { return support_; }

 private:
  std::vector<int> blocks_;  // first pixels of the blocks with candidates
  cv::Mat_<float> weights_, scatter_;
  InverseDepthImage smoothed_;
  cv::Mat_<std::uint8_t> support_;
};

}  // namespace rgbd_sfm_fusion
