// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/geometry/se3.h"

namespace rgbd_sfm_fusion {

/// How the camera came to a frame from the frame before.
struct Step {
  static constexpr double kLongest = 0.3;  ///< [s] for which a velocity holds: 5 Hz, with late frames

  Vector6 twist = Vector6::Zero();  ///< of T_frame_last
  double interval = 0.0;            ///< [s]; 0 where the velocity is unknown

  bool isKnown() const { return interval > 0.0 && interval <= kLongest; }
  /// Motion in `time` [s]; none where the velocity is unknown.
  Vector6 during(double time) const {
    return isKnown() ? Vector6(twist * (time / interval)) : Vector6::Zero();
  }
};

}  // namespace rgbd_sfm_fusion
