// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// A larger difference of depth between neighbouring pixels is a step between two surfaces. A smaller
/// difference may be the slope of one surface. The ratio is relative to depth: a surface seen at 80 degrees
/// from its normal has 1 % per pixel.
constexpr float kStepRatio = 0.03f;

/// Largest σ / Z of depth that is used: with a larger one, depth is as good as none. So a step beside far
/// depth raises the ratio no further.
constexpr float kMaxRelativeSigma = 0.199f;

/// Adds the variance of depth that an error of the pixel's position makes. On a slope, this variance is the
/// mean of (∇Z · δu)² with δu ~ N(0, sigma²). At a step, it is P * step², where P is the probability that the
/// step lies on the other side of the pixel. The gradient belongs to the pixel's own surface, and is taken
/// from the neighbours on it. The gradient counts where it stands out of the depth's own variance. No
/// variance is raised beyond kMaxRelativeSigma.
class LateralVariance {
 public:
  /// @param sigma [px] of the position, in x and in y
  LateralVariance(float sigma, int width);

  /// @param depth             NaN = none
  /// @param variance          of row `y`; NaN stays NaN
  /// @param surface_variance  [out] the variance without the term of steps: the variance of the pixel's own
  ///                          surface; may be null
  void addToRow(const DepthImage& depth, int y, float* variance, float* surface_variance = nullptr) {
    addToRow(depth, y, {0, depth.cols}, variance, surface_variance);
  }

  /// The same for some columns.
  void addToRow(const DepthImage& depth, int y, const cv::Range& columns, float* variance,
                float* surface_variance = nullptr);

 private:
  float sigma_;
  float step_probability_;
  std::vector<float> none_;        ///< a row without depth, for beyond the image
  std::vector<float> low_, high_;  ///< the row, with one more value before and after it
  std::vector<float> scratch_;
};

}  // namespace rgbd_sfm_fusion
