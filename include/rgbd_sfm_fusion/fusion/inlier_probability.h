// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "rgbd_sfm_fusion/fusion/gaussian_fusion.h"

namespace rgbd_sfm_fusion {

/// What speaks for and against an SfM depth that no sensor depth can contradict: what is around it.
struct Evidence {
  int agreeing = 0;      ///< of 24 pixels around, those with an SfM depth of the same surface
  float farther = 0.0F;  ///< [m] depth of a surface behind, beyond a gap beside the pixel's own; 0 = none
};

/// Of the 24 pixels that are 0, 2 or 4 px away by row and column, those whose depth differs by less than 5 %.
/// Wrong matches have few of them, and what is published has been smoothed over them.
int agreeingNeighbours(const DepthImage& depth, const cv::Point& pixel);

/// How wrong SfM depth is, by the number of neighbours that agree with it: learned where the sensor sees the
/// same pixel, for those where it does not. A camera's motion, its calibration and the scene decide it: with
/// a single neighbour, a quarter of a rendered room is wild, and two thirds of a recorded desk.
class AgreementStatistics {
 public:
  /// What a frame tells; what frames before told counts for less.
  /// @param sfm       [m] of the frame, before fusion
  /// @param farthest  [m] of sensor depth that is learned from
  void observe(const GaussianDepth& sfm, const GaussianDepth& sensor, float farthest);

  /// Share of depths that are more than 10 % off.
  double outlierShare(int agreeing) const;

  /// Real over stated variance: mean of min(e² / σ², 25), at least 1/2.
  double varianceFactor(int agreeing) const;

 private:
  struct Counts {
    double pixels = 0.0, outliers = 0.0, squares = 0.0;
  };
  static constexpr std::size_t kWidth = 3;  // neighbours of a class
  using Classes = std::array<Counts, 24 / kWidth + 1>;

  const Counts& seen(int agreeing) const { return seen_[static_cast<std::size_t>(agreeing) / kWidth]; }

  Classes seen_;
};

/// Probability that an SfM depth is right to a tenth. Besides what its neighbours tell: both sides of an
/// occluding contour get the depth of the surface in front, of which the far side's is wrong; of rendered
/// SfM-only pixels that are beside a surface behind, 5 %.
double inlierProbability(const Evidence& evidence, const AgreementStatistics& statistics);

/// Of depth that SfM alone has.
struct SfmOnlyLimits {
  double min_probability;     ///< [1] that it is right
  double max_relative_sigma;  ///< [1] σ / Z
};

/// Drops SfM-only depths beyond the limits. The variance of others becomes what the statistics make of it,
/// and at the end of a surface that of a mixture with the one behind, which may not be seen; and gets a floor
/// of half a per cent of Z, since nothing checks them.
/// @param sfm  [m] of the frame, before fusion
void judgeSfmOnly(const DepthImage& sfm, const AgreementStatistics& statistics, const SfmOnlyLimits& limits,
                  GaussianFusion& fusion);

}  // namespace rgbd_sfm_fusion
