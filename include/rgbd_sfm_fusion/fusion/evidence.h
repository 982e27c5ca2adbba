// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <opencv2/core.hpp>

#include "rgbd_sfm_fusion/fusion/provenance.h"
#include "rgbd_sfm_fusion/fusion/sensor_depth.h"
#include "rgbd_sfm_fusion/fusion/sfm_points.h"

namespace rgbd_sfm_fusion {

struct GaussianFusion;

/// What the pixels around an SfM depth say of it, by cells of 4 x 4 px. Sums go over the cell, over the cells
/// beside it with a weight of 1/2, and over the cells at its corners with a weight of 1/4. There is no other
/// length: depth is wrong in areas of about this size, since stereo matches windows and published depth is
/// smoothed.
///
/// A Beta distribution describes how probable it is that SfM and the sensor see one surface. Each pixel whose
/// two depths agree is a vote for it. Each pixel whose two depths contradict each other is a vote against it.
///
/// The frame's SfmState does not correct all that SfM's errors have in common. Neighbouring pixels share
/// poses, epipolar lines and the mean over a surface, so their remaining errors are alike. A sensor's noise
/// is alike in a few pixels only. So the mean difference r of inverse depth, SfM less sensor, shows SfM's
/// common error c. Half of SfM's variance is taken as common, c ~ N(0, σ_ρ²/2), and then
///
///     c | r ~ N(s r, (1 - s) σ_ρ²/2),   s = (σ_ρ²/2) / (σ_ρ²/2 + σ_r²),   σ_r² = 9 / Σ p
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

/// What the surroundings of an SfM depth say for and against it. No sensor depth can contradict it.
struct SfmOnlySurroundings {
  int agreeing = 0;      ///< how many of 24 pixels around have an SfM depth of the same surface
  float farther = 0.0F;  ///< [m] of a surface behind the pixel's own, across a gap; 0 = none
};

/// There are 24 pixels that are 0, 2 or 4 px away by row and column. This counts the pixels whose depth
/// differs by less than 6 %: a step would be 3 % per pixel. Wrong matches have few such neighbours; published
/// depth has been smoothed over them.
int agreeingNeighbours(const DepthImage& depth, const cv::Point& pixel);

/// How wrong SfM depth is, by the number of neighbours that agree with it. It is learned at pixels that the
/// sensor sees, and used at pixels that the sensor does not see. It depends on the camera's motion, on the
/// calibration and on the scene: of pixels with a single neighbour that agrees, a quarter is wild in a
/// rendered room, and two thirds at a recorded desk.
class AgreementStatistics {
 public:
  static constexpr float kRight = 0.1f;  ///< [1] a depth counts as right if its relative error is smaller
  static constexpr int kBeside = 2;      ///< neighbours on each side of a pixel, by row and column
  static constexpr int kSpacing = 2;     ///< [px] between them

  /// One value for each number of neighbours that may agree.
  template <typename Value>
  using ByAgreeing = std::array<Value, (2 * kBeside + 1) * (2 * kBeside + 1)>;

  /// Learns from a frame. Earlier frames count for less.
  /// @param points    of the frame
  /// @param sfm       [m] of the frame, before fusion
  /// @param farthest  [m] of the sensor depth that is used for learning
  void observe(const SfmPoints& points, const DepthImage& sfm, float farthest);

  /// Share of depths that are wrong.
  double outlierShare(int agreeing) const;

  /// Real over stated variance: mean of min(e² / σ², 25), but at least Evidence::kShare. What neighbours have
  /// wrong in common is not taken off: where the sensor sees nothing, there may be more of it.
  double varianceFactor(int agreeing) const;

 private:
  struct Counts {
    double pixels = 0.0, outliers = 0.0, squares = 0.0;
  };

  const Counts& seen(int agreeing) const { return seen_[static_cast<std::size_t>(agreeing)]; }

  ByAgreeing<Counts> seen_;
};

/// Probability that an SfM depth is right. The neighbours tell most of it. Besides, both sides of
/// an occluding contour get the depth of the surface in front, which is wrong on the far side. This happens
/// to 5 % of the rendered SfM-only pixels that have a surface behind beside them.
double inlierProbability(const SfmOnlySurroundings& surroundings, const AgreementStatistics& statistics);

/// Limits of depth that SfM alone has.
struct SfmOnlyLimits {
  double min_probability;     ///< [1] that the depth is right
  double max_relative_sigma;  ///< [1] σ / Z
  bool correct_variance;      ///< by the statistics
};

/// Drops SfM-only depths beyond the limits, and corrects the variance of the others. Beside a surface behind,
/// the variance is that of a mixture with this surface.
/// @param sfm  [m] of the frame, before fusion
void judgeSfmOnly(const DepthImage& sfm, const AgreementStatistics& statistics, const SfmOnlyLimits& limits,
                  GaussianFusion& fusion);

/// Drops SfM depth at the rims of the sensor's holes, where it may belong to either side: of pixels that have
/// no sensor depth, but sensor depth near. Against exact truth, a fifth of this SfM depth is more than 5
/// sigma off, and no variance tells which.
/// @param sensor  [m], [m^2] H x W, NaN = none
/// @param width   [px] from sensor depth within which a pixel is near to it; 0: none is
/// @param sfm     H x W, NaN = none
void dropAtRims(const GaussianDepth& sensor, int width, GaussianDepth& sfm);

}  // namespace rgbd_sfm_fusion
