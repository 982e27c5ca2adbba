// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Larger differences of depth between neighbouring pixels are steps between two surfaces; smaller ones may
/// be the slope of one. Relative to depth: a surface seen at 80 degrees from its normal has 1 % per pixel.
constexpr float kStepRatio = 0.03f;

/// What an error of a pixel's position does to its depth: (∇Z · δu)² with δu ~ N(0, sigma²) on a slope, and
/// at a step, which may lie on the other side of the pixel, P(it does) * step². The gradient is that of the
/// pixel's own surface, from the neighbours there are, and counts where it stands out of the depth's own
/// variance. A variance is not raised beyond (0.19 Z)² by this.
class LateralVariance {
 public:
  /// @param sigma [px] of the position, in x and in y
  LateralVariance(float sigma, int width);

  /// @param depth             NaN = none
  /// @param variance          of row `y`; where it is NaN, it stays NaN
  /// @param surface_variance  [out] the same without the term of steps: that of the pixel's own surface;
  ///                          may be null
  void addToRow(const DepthImage& depth, int y, float* variance, float* surface_variance = nullptr);

 private:
  float sigma_;
  float step_probability_;
  std::vector<float> none_;        ///< beside the image
  std::vector<float> low_, high_;  ///< with a value before and after the row
  std::vector<float> scratch_;
};

}  // namespace rgbd_sfm_fusion
