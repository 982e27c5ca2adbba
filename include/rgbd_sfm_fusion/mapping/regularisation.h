// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "rgbd_sfm_fusion/image/row_bands.h"
#include "rgbd_sfm_fusion/mapping/semi_dense_map.h"

namespace rgbd_sfm_fusion {

/// Smoothing over neighbours that agree (Engel et al. 2013, section 2.4), and priors for gaps between them.
class Regulariser {
 public:
  /// Neighbours of a reliable pixel that agree with it. A gap gets a prior from one neighbour more: as many
  /// estimates as are of one surface there.
  static constexpr int kMinSupport = 2;
  /// [px] Averages reach as far as the pattern that a match compares: so far it has been one surface.
  static constexpr int kRadius = kPatternRadius;
  /// Pixels in an average, 13: every other one of a square, with its corners.
  static constexpr int kAveraged = ((2 * kRadius + 1) * (2 * kRadius + 1) + 1) / 2;
  /// Patterns overlap, so neighbours' errors are alike: of the kAveraged pixels in an average, so many count
  /// as one.
  static constexpr float kAlike = 4.5F;

  /// Starts a new keyframe: from now on, only its blocks with candidates are looked at.
  void setCandidates(const StereoCandidates& candidates, const cv::Size& size);

  /// @param bands  to renew the results of
  void apply(const SemiDenseMap& map, const RowBands& bands = RowBands::all());

  /// To be called before apply(). Gives pixels that have a single observation and no neighbour that agrees a
  /// prior: their own estimate.
  void setPriors(const std::vector<StereoObservation>& observations, const SemiDenseMap& map);

  /// Whether too few neighbours agree with the pixel's estimate, while half of them or more agree with each
  /// other. Fewer are not enough: beside a step, they may be of the other surface.
  bool isContradicted(const SemiDenseMap& map, int pixel) const;

  /// Averages once more, over agreeing neighbours within four pixels. The result has the variance of the
  /// mean: a poor estimate among good neighbours becomes as good as they are.
  /// @param from    estimates of this keyframe, averaged once; 0 and infinity = none
  /// @param result  overwritten in the bands
  void smoothWidely(const InverseDepthImage& from, InverseDepthImage& result,
                    const RowBands& bands = RowBands::all());

  /// A pixel with an estimate has the weighted mean of the agreeing neighbours within two pixels. The pixel
  /// keeps its own variance, not a reduced one, since neighbours' errors are alike. A pixel without an
  /// estimate, but with enough neighbours, has the neighbours' mean and spread, as a prior for a search.
  const InverseDepthImage& smoothed() const { return smoothed_; }

  /// The mean scatter of the agreeing neighbours, since one pixel's few observations say little. Meaningless
  /// at a pixel without an estimate.
  const cv::Mat_<float>& scatter() const { return scatter_; }

  /// Number of neighbours that agree with a pixel's estimate; 0 without an estimate.
  const cv::Mat_<std::uint8_t>& support() const { return support_; }

 private:
  void weigh(const cv::Mat_<float>& variance, int first, int end);

  std::vector<std::vector<int>> blocks_;  // per band, first pixels of the blocks with candidates
  cv::Mat_<float> weights_, scatter_;
  InverseDepthImage smoothed_;
  cv::Mat_<std::uint8_t> support_;
};

}  // namespace rgbd_sfm_fusion
