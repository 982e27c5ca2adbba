// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>

#include "rgbd_sfm_fusion/fusion/overlap.h"

namespace rgbd_sfm_fusion {

/// Real over stated variance of SfM depth at scale `alpha`, as the sensor shows it. It is the median of (d -
/// αμ)² / (σ_d² + α²σ² + (αμ)⁴σ_shared²), over the median of χ², at pixels where the sensor is the better of
/// the two. Outliers do not move the median. Pixels that the sensor does not see are assumed to be like the
/// pixels that it sees.
/// @param shared_sigma  [1/m] sharedInverseDepthSigma(); the factor does not include it
/// @return within [1/20, 100]; NaN where there are fewer than 200 samples of such pixels
double sfmVarianceFactor(const Overlap& overlap, double alpha, double shared_sigma = 0.0);

/// [1/m] Each tile of the image has a median difference of inverse depth, SfM at scale `alpha` less sensor.
/// This is the robust standard deviation of these medians from zero. An error of the poses (a turn taken for
/// a move) shifts all inverse depths of a region alike. No pixel's variance tells this shift, and it is worst
/// far away.
/// @return NaN where too few tiles have both depths
double sharedInverseDepthSigma(const Overlap& overlap, double alpha);

/// Line through the differences of inverse depth, SfM less sensor, over inverse depth.
struct Stretch {
  double slope = std::numeric_limits<double>::quiet_NaN();  ///< [1] NaN where the frame does not tell
  double slope_variance = 0.0;                              ///< [1]
  double middle = 0.0;  ///< [1/m] weighted mean inverse depth of the tiles that were fitted
};

/// A robust line through the tiles' medians. SfM stretches: if a turn of the camera was taken for a move,
/// near and far depths keep their order, but not their ratio (the bas-relief ambiguity). The sensor's own
/// depth may be bent, too.
Stretch fitStretch(const Overlap& overlap, double alpha);

/// Errors of SfM depth besides the errors that SfmState describes.
struct SfmErrors {
  double variance_factor = 1.0;  ///< [1] real over stated variance of SfM depth
  double shared_sigma = 0.0;     ///< [1/m] error of inverse depth that a region shares: an error of the poses
  double stretch_sigma = 0.0;    ///< [1] error of inverse depth, per difference from `stretch_middle`
  double stretch_middle = 0.0;   ///< [1/m] inverse depth
};

/// What the sensor has shown so far of SfM's errors, at the scale of each frame alone. SfmState corrects a
/// part of these errors, but all of them stay in the variance. The reason: in holes of recorded depth, errors
/// are 1.75 times as large as the state's covariance and the scatter in the overlap promise (hallway, depth
/// beyond 4 m).
class SfmCalibration {
 public:
  /// Learns from the overlap of a frame.
  void observe(const Overlap& overlap, double alpha);

  SfmErrors errors() const;

 private:
  void observeStretch(const Stretch& stretch);

  double factor_ = 0.0;            // [1] real over stated variance; 0 = not yet known
  double shared_variance_ = 0.0;   // [1/m²] of the error that a region shares; 0 = not yet known
  double stretch_variance_ = 0.0;  // [1] mean square of slopes, less their own variance
  double stretch_middle_ = 0.0;    // [1/m] of the last frame with a line
  double stretch_weight_ = 0.0;    // of the frames with a line
};

}  // namespace rgbd_sfm_fusion
