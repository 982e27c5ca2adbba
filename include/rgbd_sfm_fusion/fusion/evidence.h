// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "rgbd_sfm_fusion/fusion/sensor_depth.h"
#include "rgbd_sfm_fusion/fusion/sfm_points.h"

namespace rgbd_sfm_fusion {

/// What the pixels around an SfM depth say of it, by cells of 4 x 4 px. Sums go over the cell, over the cells
/// beside it with a weight of 1/2, and over the cells at its corners with a weight of 1/4. There is no other
/// length: depth is wrong in areas of about this size, since stereo matches windows and published depth is
/// smoothed.
///
/// A Beta distribution describes how probable it is that SfM and the sensor see one surface. Each pixel whose
/// two depths agree (`max_chi_squared`) is a vote for it. Each pixel whose two depths do not, though a step
/// in the sensor's depth is allowed for, is a vote against it.
///
/// The frame's SfmState does not correct all that SfM's errors have in common. Neighbouring pixels share
/// poses, epipolar lines and the mean over a surface, so their remaining errors are alike. A sensor's noise
/// is alike in a few pixels only. So the mean difference r of inverse depth, SfM less sensor, over pixels
/// whose depths agree and are in the sensor's range, shows SfM's common error e. Half of SfM's variance,
/// after alignment, is taken as common, e ~ N(0, σ_ρ²/2), and then
///
///     e | r ~ N(s r, (1 - s) σ_ρ²/2),   s = (σ_ρ²/2) / (σ_ρ²/2 + σ_r²),   σ_r² = 9 / Σ p
///
/// p is the precision of the sensor's inverse depth, and the weight of a pixel in r. Nine pixels count as
/// one, since sensors match windows. On slopes, an error of registration is the same all over an area, and
/// does not average out: so p is multiplied by the share of noise in the variance. The squares of the cells'
/// weights would make σ_r² 1.8 times smaller. The larger σ_r² stands for two things that are left out: SfM's
/// other half is in r, and so is the pixel's own sensor depth.
struct Evidence {
  static constexpr int kCell = 4;  ///< [px]
  /// Share of SfM's variance that is common. The pixels around are 4 px from the corrected pixel on average.
  /// In the rendered room, errors of pixels 4 px apart correlate by 0.53 (scripts/fit_fusion).
  static constexpr float kShare = 0.5f;

  cv::Mat_<float> odds;            ///< logarithm of the odds that both depths are of one surface
  cv::Mat_<float> difference;      ///< [1/m] r; 0 where no pixel has a say
  cv::Mat_<float> noise_variance;  ///< [1/m²] σ_r²; infinite where no pixel has a say
};

/// @param sfm              points collected with `sensor`
/// @param max_chi_squared  of depths that agree
Evidence evidenceAround(const SensorDepth& sensor, const SfmPoints& sfm, float max_chi_squared);

}  // namespace rgbd_sfm_fusion
