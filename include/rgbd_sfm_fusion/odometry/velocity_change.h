// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "rgbd_sfm_fusion/odometry/step.h"

namespace rgbd_sfm_fusion {

/// The errors of the velocities that alignment uses. A frame has the mean velocity since the frame before; a
/// keyframe has the mean velocity between the frames on either side of it. Velocity is taken to walk at
/// random. The strength of this walk is learned from the change of mean velocities from frame to frame. An
/// image without a known velocity, as after a loss, is taken to stand still: its error is as large as the
/// camera is fast, which is learned, too.
class VelocityChange {
 public:
  /// Learns from the step to a frame, and from its change since the step before, if both are known.
  void observe(const Step& step);

  /// [(1/s)²] Variances of the difference between the velocities of a frame and its keyframe.
  /// @param of_frame, of_keyframe  whether they are known
  Vector6 variances(bool of_frame, bool of_keyframe) const;

  /// Covariance of the error of the motion [tracker units, rad] during the readout, of frame and keyframe
  /// together.
  /// @param of_frame       [1/s] velocity that the alignment has used; none: it is not known
  /// @param of_keyframe    [1/s] the same of the keyframe, in the frame's axes. A wrong readout time bends
  ///                       both images, so that only the difference of their velocities counts
  /// @param readout_time   [s] root of its mean square
  /// @param readout_error  [s] of the readout time that the alignment has used: root of its mean square
  Matrix6 duringReadout(const std::optional<Vector6>& of_frame, const std::optional<Vector6>& of_keyframe,
                        double readout_time, double readout_error) const;

 private:
  /// Per axis, as moves and turns differ [(1/s)^2].
  struct MeanSquares {
    double moves = 0.0, turns = 0.0;

    void follow(const Vector6& sample);
    Vector6 perAxis() const;
  };
  Step last_;
  MeanSquares velocity_, change_;  // the change: from frame to frame
};

}  // namespace rgbd_sfm_fusion
