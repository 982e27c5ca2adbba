// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "rgbd_sfm_fusion/tracking/calibration_equations.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// [s] Readout times of real rolling shutters. The slowest takes all of a frame at 30 Hz.
constexpr double kFastestReadout = 0.010, kSlowestReadout = 0.033;

/// Learns the readout time of a rolling shutter (method.md 10) from the residuals of aligned frames: an image
/// that was read out while the camera moved is bent in a way that no pose explains. A Kalman filter estimates
/// the time. It is negative where the last row is read first, as in the turned image of a camera that hangs
/// upside down.
///
/// Each frame's measurement is a Gauss–Newton step of the photometric error, together with pose and
/// brightness. Its variance has two parts. One is the scatter of the images' residuals (addScatter()); depths
/// and brightness of the keyframe have a part in it, so that all frames of a keyframe share it. The other is
/// that the camera is not as fast during the readout as it was on the way to the image: a change of velocity
/// bends the image like a wrong readout time. This part is each frame's own.
class ReadoutEstimator {
 public:
  /// [s] of the readout of a sensor of which nothing is known: half of the slowest.
  static constexpr double kStartSigma = kSlowestReadout / 2.0;

  /// @param time  [s] to start from
  explicit ReadoutEstimator(double time = 0.0)
      : start_(time), before_{time, kStartSigma * kStartSigma}, now_(before_) {}

  /// Learns from an aligned frame.
  /// @param keyframe            that it was aligned with
  /// @param velocity_variances  [(1/s)²] of the difference between the velocities of frame and keyframe
  /// @param aligned_time        [s] readout time that the alignment has used; it may be an older estimate
  /// @param interval            [s] since the last frame
  void observe(const CalibrationEquations& equations, Stamp keyframe, const Vector6& velocity_variances,
               double aligned_time, double interval);

  /// [s] from the first row to the last; negative from the last one to the first; 0 while there is no clear
  /// sign of a rolling shutter.
  double readoutTime() const;

  /// [s] Standard deviation of readoutTime(), by Bayes' rule. A shutter is either global, with a readout time
  /// of exactly 0, or rolling, which takes 10 ms or more, either way. So once a camera has moved enough, a
  /// global shutter is known exactly, though the filter's own variance never becomes 0.
  double sigma() const;

 private:
  struct Belief {
    double time, variance;  // [s, s²]
  };

  /// What the frames of one keyframe say together, each weighed by its variance.
  struct Evidence {
    double weights = 0.0, times = 0.0, of_images = 0.0, of_motion = 0.0;  // sums

    void add(double time, double variance_of_images, double variance_of_motion);
    Belief mean() const;
  };

  double start_;
  Stamp keyframe_ = -1;  // no frame has been used yet
  Evidence frames_;      // of the keyframe
  Belief before_, now_;  // before the keyframe's frames, and with them
};

}  // namespace rgbd_sfm_fusion
