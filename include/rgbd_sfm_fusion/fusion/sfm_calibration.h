// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>

#include "rgbd_sfm_fusion/fusion/overlap.h"

namespace rgbd_sfm_fusion {

/// Real over stated variance of SfM depth at scale `alpha`, as the sensor shows it: from the median of
/// (d - αμ)² / (σ_d² + α²σ² + (αμ)⁴σ_shared²), which outliers do not move, where the sensor is the better of
/// the two. Pixels that the sensor does not see are taken to be like those it sees.
/// @param shared_sigma  [1/m] sharedInverseDepthSigma(), which is not part of the factor
/// @return within [1/20, 100]; NaN where there are fewer than 200 samples of such pixels
double sfmVarianceFactor(const Overlap& overlap, double alpha, double shared_sigma = 0.0);

/// [1/m] Robust standard deviation, over the image's tiles, of their median difference in inverse depth
/// between SfM at scale `alpha` and the sensor. An error of the poses (a turn taken for a move) shifts all
/// inverse depths of a region alike, which no pixel's variance tells, and which is worst far away.
/// @return NaN where too few tiles have both depths
double sharedInverseDepthSigma(const Overlap& overlap, double alpha);

/// Line through the differences of inverse depth, SfM less sensor, over inverse depth.
struct Stretch {
  double slope = std::numeric_limits<double>::quiet_NaN();  ///< [1] NaN where the frame does not tell
  double slope_variance = 0.0;                              ///< [1]
  double middle = 0.0;  ///< [1/m] weighted mean inverse depth of what the line was fitted to
};

/// SfM stretches: with a turn of the camera for a move, near and far depths keep their order, but not their
/// ratio (the bas-relief ambiguity), and a sensor's own depth may be bent, too. A robust line through the
/// tiles' medians.
Stretch fitStretch(const Overlap& overlap, double alpha);

/// What errors of SfM depth there are besides those of SfmState.
struct SfmErrors {
  double variance_factor = 1.0;  ///< [1] real over stated variance of SfM depth
  double shared_sigma = 0.0;     ///< [1/m] of inverse depth, shared by a region: an error of the poses
  double stretch_sigma = 0.0;    ///< [1] of an error of inverse depth that grows from `stretch_middle` on
  double stretch_middle = 0.0;   ///< [1/m] inverse depth
};

/// What the sensor has shown so far of SfM's errors at a frame's scale alone. All of it is variance, and is
/// kept beside SfmState, which corrects a part of it: in holes of recorded depth, errors are 1.75 times as
/// large as the state's covariance and what the overlap shows of pixels and tiles have it (hallway, depth
/// beyond 4 m).
class SfmCalibration {
 public:
  /// What a frame adds.
  void observe(const Overlap& overlap, double alpha);

  SfmErrors errors() const;

 private:
  void observeStretch(const Stretch& stretch);

  double factor_ = 0.0;            // [1] real over stated variance; 0 = not yet known
  double shared_variance_ = 0.0;   // [1/m²] of inverse depth that regions share; 0 = not yet known
  double stretch_variance_ = 0.0;  // [1] mean square of slopes, less that of their errors
  double stretch_middle_ = 0.0;    // [1/m] of the last frame that told
  int stretches_ = 0;              // frames that told
};

}  // namespace rgbd_sfm_fusion
