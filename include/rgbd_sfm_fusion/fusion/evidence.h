// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "rgbd_sfm_fusion/fusion/sensor_depth.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// What the pixels around say of an SfM depth, by cells of 4 x 4 px. It is summed over the cell and, with
/// weights of 1/2 and 1/4, over those beside it and at its corners. That is the only length there is: depth
/// is wrong in areas of about this size, since stereo matches windows, and what is published is smoothed.
///
/// The probability that SfM's depth is of the surface that the sensor sees is the mean of a Beta
/// distribution: pixels with both depths that agree are for it, those that contradict are against it, and so
/// is each pixel where the sensor's surface ends, at a step or at a hole. There SfM's depth is as often that
/// of the one side as of the other.
///
/// What SfM's errors have in common is the residual field, what the frame's SfmState leaves. The errors are
/// alike in neighbouring pixels, which share poses, epipolar lines and the mean over a surface; a sensor's
/// noise is alike in a few pixels only. So the mean difference r of the two, SfM less sensor, shows SfM's
/// common error c. Half of SfM's variance is taken as common, c ~ N(0, σ_ρ²/2), and then
///
///     c | r ~ N(s r, (1 - s) σ_ρ²/2),   s = (σ_ρ²/2) / (σ_ρ²/2 + σ_r²),   σ_r² = 9 / Σ p
///
/// p is the sensor's precision of inverse depth, and the weight in r. Nine pixels count as one, since sensors
/// match windows. What registration does to depth on slopes is the same all over an area, and does not
/// average out: p is less by the share of noise in the variance. The squares of the weights of cells would
/// make σ_r² 1.8 times less; that stands for what is left out, SfM's other half in r, and that a pixel's own
/// sensor depth is part of r.
struct Evidence {
  static constexpr int kCell = 4;  ///< [px]
  /// Of SfM's variance. In the rendered room errors of pixels 4 px apart, as they are on average from the one
  /// that is corrected, correlate by 0.53 (scripts/fit_fusion).
  static constexpr float kShare = 0.5f;

  cv::Mat_<float> odds;            ///< logarithm of those that both depths are of one surface
  cv::Mat_<float> difference;      ///< [1/m] r; 0 where there is none
  cv::Mat_<float> noise_variance;  ///< [1/m²] σ_r²; infinite where there is none

  float probability(int y, int x) const;  ///< that both depths at a pixel are of one surface, before they
                                          ///< are compared there
};

/// @param sfm  [m] H x W, NaN = none
/// @param max_chi_squared  of depths that agree
Evidence evidenceAround(const SensorDepth& sensor, const GaussianDepth& sfm, float max_chi_squared);

}  // namespace rgbd_sfm_fusion
