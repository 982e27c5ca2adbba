// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Zero, ROS's "no time", for kNoStamp.
inline ros::Time toRosTime(Stamp stamp) {
  return stamp == kNoStamp ? ros::Time() : ros::Time().fromNSec(static_cast<std::uint64_t>(stamp));
}

/// kNoStamp for zero.
inline Stamp fromRosTime(const ros::Time& time) {
  return time.isZero() ? kNoStamp : static_cast<Stamp>(time.toNSec());
}

}  // namespace rgbd_sfm_fusion
