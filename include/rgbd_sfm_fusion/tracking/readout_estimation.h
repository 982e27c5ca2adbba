// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "rgbd_sfm_fusion/tracking/calibration_equations.h"

namespace rgbd_sfm_fusion {

/// [s] Readout times of real rolling shutters. The slowest takes all of a frame at 30 Hz.
constexpr double kFastestReadout = 0.010, kSlowestReadout = 0.033;

/// Learns the readout time of a rolling shutter (method.md 10) from the residuals of aligned frames: an image
/// that was read out while the camera moved is bent in a way that no pose explains. A Kalman filter estimates
/// the time. It is negative where the last row is read first, as in the turned image of a camera that hangs
/// upside down. Each frame's measurement is a Gauss–Newton step of the photometric error, together with pose
/// and brightness.
class ReadoutEstimator {
 public:
  /// [s] of the readout of a sensor of which nothing is known: half of the slowest.
  static constexpr double kStartSigma = kSlowestReadout / 2.0;

  /// @param time  [s] to start from
  explicit ReadoutEstimator(double time = 0.0) : start_(time), time_(time) {}

  /// Learns from an aligned frame.
  /// @param aligned_time  [s] readout time that the alignment has used; it may be an older estimate
  /// @param interval      [s] since the last frame
  void observe(const CalibrationEquations& equations, double aligned_time, double interval);

  /// [s] from the first row to the last; negative from the last one to the first; 0 while there is no clear
  /// sign of a rolling shutter.
  double readoutTime() const;

  /// [s] Standard deviation of readoutTime(), by Bayes' rule. A shutter is either global, with a readout time
  /// of exactly 0, or rolling, which takes 10 ms or more, either way. So once a camera has moved enough, a
  /// global shutter is known exactly, though the filter's own variance never becomes 0.
  double sigma() const;

  /// [s] The same by the filter alone, for which all times are equally likely. It tells how much was learned.
  double filterSigma() const { return std::hypot(std::sqrt(variance_), time_ - readoutTime()); }

 private:
  double start_, time_;
  double variance_ = kStartSigma * kStartSigma;
};

}  // namespace rgbd_sfm_fusion
