// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/odometry/odometry_options.h"
#include "rgbd_sfm_fusion/odometry/step.h"
#include "rgbd_sfm_fusion/odometry/velocity_change.h"
#include "rgbd_sfm_fusion/tracking/readout_estimation.h"

namespace rgbd_sfm_fusion {

/// What tracking knows of the camera's shutter: the readout time as set, or as learned up to this frame, and
/// what a changing velocity does to the poses of images that are read out while it changes.
class Shutter {
 public:
  explicit Shutter(const OdometryOptions& options) { reset(options); }

  /// Forgets what was learned.
  void reset(const OdometryOptions& options);

  /// Goes on with what was learned, if the options set the same readout time as before.
  void setOptions(const OdometryOptions& options);

  /// Learns from an aligned frame.
  /// @param problem        the problem that `aligned` is the result of
  /// @param keyframe_step  to the keyframe, from the frame before it
  /// @param step           to the frame, from the frame before; unknown after a loss
  void observe(const AlignmentProblem& problem, const AlignmentResult& aligned, const Step& keyframe_step,
               const Step& step);

  double readoutTime() const;   ///< [s] from the first row to the last
  double readoutSigma() const;  ///< [s] its standard deviation; 0: it is set

  /// Whether a readout time turned out to be wrong. Stereo depth from before a rolling shutter was known is
  /// several per cent off. It stays so, as tracking and stereo confirm each other.
  bool contradicts(double readout_time) const;

  /// The part that the shutter has in the covariance of an aligned pose.
  Matrix6 covariance(const AlignmentResult& aligned) const;

 private:
  bool is_learned_ = false;
  double set_time_ = 0.0;  // [s]
  ReadoutEstimator estimator_;
  VelocityChange velocity_change_;
};

}  // namespace rgbd_sfm_fusion
