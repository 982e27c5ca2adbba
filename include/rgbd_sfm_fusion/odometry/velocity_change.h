// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/odometry/step.h"

namespace rgbd_sfm_fusion {

/// How far the velocities at a frame and at its keyframe may be from what is known of them when they are
/// aligned: the mean velocity since the frame before, and that between the frames either side. Velocity is
/// taken to walk at random; how strongly is learned from how its means change from frame to frame.
class VelocityChange {
 public:
  /// The step to a frame, and with it the change from the one before, where both are known.
  void observe(const Step& step);

  /// Covariance of the error of the motion [tracker units, rad] during the readout, of frame and keyframe
  /// together.
  /// @param readout_time   [s]
  /// @param readout_sigma  [s] its standard deviation
  Matrix6 duringReadout(double readout_time, double readout_sigma) const;

 private:
  Step last_;
  double moves_ = 0.0, turns_ = 0.0;  // mean squared change, per axis [(1/s)^2]
};

}  // namespace rgbd_sfm_fusion
