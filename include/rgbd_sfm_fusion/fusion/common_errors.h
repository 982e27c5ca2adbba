// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "rgbd_sfm_fusion/fusion/gaussian_fusion.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// What SfM's errors of inverse depth have in common around each cell of 4 x 4 px.
///
/// They are alike in neighbouring pixels, which share poses, epipolar lines and the mean over a surface; a
/// sensor's noise is alike in a few pixels only. So the mean difference r of the two, SfM less sensor, shows
/// SfM's common error c. Half of SfM's variance is taken as common, c ~ N(0, σ_ρ²/2), and then
///
///     c | r ~ N(s r, (1 - s) σ_ρ²/2),   s = (σ_ρ²/2) / (σ_ρ²/2 + σ_r²),   σ_r² = 9 / Σ p
///
/// p is the sensor's precision of inverse depth, and the weight in r. Nine pixels count as one, since sensors
/// match windows. What registration does to depth on slopes is the same all over an area, and does not
/// average out: p is less by the share of noise in the variance. The sums are over pixels that are fused, of
/// the cell and, with weights of 1/2 and 1/4, of those beside it and at its corners. The squares of these
/// would make σ_r² 1.8 times less; that stands for what is left out, SfM's other half in r, and that a
/// pixel's own sensor depth is part of r.
struct CommonErrors {
  static constexpr int kCell = 4;  ///< [px]
  /// Of SfM's variance. In the rendered room errors of pixels 4 px apart, as they are on average from the one
  /// that is corrected, correlate by 0.53 (scripts/fit_fusion).
  static constexpr float kShare = 0.5f;

  cv::Mat_<float> difference;      ///< [1/m] r, by cell; 0 where there is none
  cv::Mat_<float> noise_variance;  ///< [1/m²] σ_r²; infinite where there is none
};

/// @param sfm         [m] H x W
/// @param provenance  H x W, values of Provenance
CommonErrors commonErrors(const SensorDepth& sensor, const DepthImage& sfm,
                          const cv::Mat_<std::uint8_t>& provenance);

}  // namespace rgbd_sfm_fusion
