// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/odometry/step.h"

namespace rgbd_sfm_fusion {

/// The errors of the velocities that alignment uses. A frame has the mean velocity since the frame before; a
/// keyframe has the mean velocity between the frames on either side of it. Velocity is taken to walk at
/// random. The strength of this walk is learned from the change of mean velocities from frame to frame.
class VelocityChange {
 public:
  /// Learns from the step to a frame, and from its change since the step before, if both are known.
  void observe(const Step& step);

  /// Covariance of the error of the motion [tracker units, rad] during the readout, of frame and keyframe
  /// together.
  /// @param of_keyframe    [1/s] velocity of the keyframe, in the frame's axes. A wrong readout time bends
  ///                       both images, so that only the difference of their velocities counts
  /// @param readout_time   [s] root of its mean square
  /// @param readout_error  [s] of the readout time that the alignment has used: root of its mean square
  Matrix6 duringReadout(const Vector6& of_keyframe, double readout_time, double readout_error) const;

 private:
  Step last_;
  double moves_ = 0.0, turns_ = 0.0;  // mean squared change, per axis [(1/s)^2]
};

}  // namespace rgbd_sfm_fusion
