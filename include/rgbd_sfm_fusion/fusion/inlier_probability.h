// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "rgbd_sfm_fusion/fusion/gaussian_fusion.h"

namespace rgbd_sfm_fusion {

/// What the surroundings of an SfM depth say for and against it. No sensor depth can contradict it.
struct SfmOnlySurroundings {
  int agreeing = 0;      ///< how many of 24 pixels around have an SfM depth of the same surface
  float farther = 0.0F;  ///< [m] of a surface behind the pixel's own, across a gap; 0 = none
};

/// There are 24 pixels that are 0, 2 or 4 px away by row and column. This counts the pixels whose depth
/// differs by less than 5 %. Wrong matches have few such neighbours; published depth has been smoothed over
/// them.
int agreeingNeighbours(const DepthImage& depth, const cv::Point& pixel);

/// How wrong SfM depth is, by the number of neighbours that agree with it. It is learned at pixels that the
/// sensor sees, and used at pixels that the sensor does not see. It depends on the camera's motion, on the
/// calibration and on the scene: of pixels with a single neighbour that agrees, a quarter is wild in a
/// rendered room, and two thirds at a recorded desk.
class AgreementStatistics {
 public:
  /// Learns from a frame. Earlier frames count for less.
  /// @param sfm       [m] of the frame, before fusion
  /// @param farthest  [m] of the sensor depth that is used for learning
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

/// Probability that an SfM depth is right to a tenth. The neighbours tell most of it. Besides, both sides of
/// an occluding contour get the depth of the surface in front, which is wrong on the far side. This happens
/// to 5 % of the rendered SfM-only pixels that have a surface behind beside them.
double inlierProbability(const SfmOnlySurroundings& surroundings, const AgreementStatistics& statistics);

/// Limits of depth that SfM alone has.
struct SfmOnlyLimits {
  double min_probability;     ///< [1] that the depth is right
  double max_relative_sigma;  ///< [1] σ / Z
};

/// Drops SfM-only depths beyond the limits. The statistics correct the variance of the other depths. Beside a
/// surface behind, the variance is that of a mixture with this surface.
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
