// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/sensor/skew_compensation.h"

namespace rgbd_sfm_fusion {

/// How the camera came to a frame from the frame before.
struct Step {
  /// [s] After a longer step, no velocity tells where the camera is. A frame may be missing at 5 Hz.
  static constexpr double kLongest = kLongestMotion;  // 0.5
  /// [s] A longer step is one at a low rate: the camera goes far from frame to frame, and mapping a frame has
  /// as much time as two frames at 30 Hz give it.
  static constexpr double kShort = 0.06;

  Vector6 twist = Vector6::Zero();  ///< of T_frame_last
  double interval = 0.0;            ///< [s]; 0 where the velocity is unknown

  bool isKnown() const { return interval > 0.0 && interval <= kLongest; }
  /// Motion in `time` [s]; none where the velocity is unknown.
  Vector6 during(double time) const {
    return isKnown() ? Vector6(twist * (time / interval)) : Vector6::Zero();
  }
  Vector6 velocity() const { return during(1.0); }  ///< [1/s]
};

}  // namespace rgbd_sfm_fusion
