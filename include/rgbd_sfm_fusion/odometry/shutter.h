// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/odometry/odometry_options.h"
#include "rgbd_sfm_fusion/odometry/step.h"
#include "rgbd_sfm_fusion/odometry/velocity_change.h"
#include "rgbd_sfm_fusion/tracking/readout_estimation.h"

namespace rgbd_sfm_fusion {

/// [s] The readout time is known, and said to be so, if its sigma is smaller.
constexpr double kKnownReadoutSigma = 0.003;

/// What tracking knows of the camera's shutter: the readout time, as it is set or as it was learned so far;
/// and how uncertain poses are because the camera's velocity changes while an image is read out.
class Shutter {
 public:
  explicit Shutter(const OdometryOptions& options) { reset(options); }

  /// Forgets what was learned.
  void reset(const OdometryOptions& options);

  /// Keeps what was learned, unless the options set another readout time than before.
  void setOptions(const OdometryOptions& options);

  /// Learns from the step to an aligned frame, from the frame before.
  void observe(const Step& step) { velocity_change_.observe(step); }

  /// Learns from an aligned frame.
  /// @param keyframe      that it was aligned with; like the frame, with a known velocity
  /// @param aligned_time  [s] readout time that the alignment has used
  /// @param interval      [s] since the frame before
  void observe(const CalibrationEquations& equations, Stamp keyframe, double aligned_time, double interval);

  double readoutTime() const;   ///< [s] from the first row to the last
  double readoutSigma() const;  ///< [s] its standard deviation; 0: it is set

  /// What the shutter adds to the covariance of an aligned pose.
  /// @param step           to the frame, from the frame before it; unknown after a loss
  /// @param aligned_time   [s] readout time that the alignment has used
  /// @param keyframe_step  to the keyframe, from the frame before it; may be unknown as well
  Matrix6 covariance(const AlignmentResult& aligned, const Step& step, double aligned_time,
                     const Step& keyframe_step) const;

 private:
  bool is_learned_ = false;
  double set_time_ = 0.0;  // [s]
  ReadoutEstimator estimator_;
  VelocityChange velocity_change_;
};

}  // namespace rgbd_sfm_fusion
