// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "rgbd_sfm_fusion/fusion/provenance.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// What SfM's errors of inverse depth have in common around each cell of 4 x 4 px.
///
/// They are alike in neighbouring pixels, which share poses, epipolar lines and the mean over a surface; the
/// sensor's are mostly each pixel's own. So the mean difference r of the two over N pixels around shows SfM's
/// common error c. With half of SfM's variance in common, c ~ N(0, σ_ρ²/2), and σ_d² the sensor's variance of
/// inverse depth,
///
///     c | r ~ N(s r, (1 - s) σ_ρ²/2),   s = (σ_ρ²/2) / (σ_ρ²/2 + 9 σ_d²/N)
///
/// where nine pixels count as one, since sensors match windows of pixels.
struct CommonErrors {
  static constexpr int kCell = 4;  ///< [px]
  /// Of SfM's variance, what is in common. In the rendered room, errors of pixels 3 to 5 px apart, as they
  /// are on average in the area of a cell, correlate by 0.5 to 0.35 (scripts/fit_fusion).
  static constexpr float kShare = 0.5f;

  cv::Mat_<float> difference;      ///< [1/m] r; 0 where N = 0
  cv::Mat_<float> noise_variance;  ///< [1/m²] of r, 9 σ_d²/N; infinite where N = 0
};

/// @param sensor      [m], [m²] H x W, with the variance of its surface
/// @param sfm         [m] H x W
/// @param provenance  H x W, values of Provenance; only what is fused counts: there the two agree
CommonErrors commonErrors(const GaussianDepth& sensor, const DepthImage& sfm,
                          const cv::Mat_<std::uint8_t>& provenance);

}  // namespace rgbd_sfm_fusion
