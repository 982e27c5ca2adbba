// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>

#include <cstdint>
#include <limits>
#include <string>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// ROS's times end 2^32 s after 1970, and its arithmetic throws beyond. No image has a stamp within a day of
/// that.
constexpr std::uint32_t kLastUsableSecond = std::numeric_limits<std::uint32_t>::max() - 86'400;

inline bool isUsable(const ros::Time& stamp) {
  return stamp.sec <= kLastUsableSecond && stamp.nsec < 1'000'000'000U;
}

inline std::string describeUsableStamps() {
  return "expected 0 to " + std::to_string(kLastUsableSecond) + " s, and less than 1e9 ns";
}

/// Zero, ROS's "no time", for kNoStamp.
inline ros::Time toRosTime(Stamp stamp) {
  return stamp == kNoStamp ? ros::Time() : ros::Time().fromNSec(static_cast<std::uint64_t>(stamp));
}

/// kNoStamp for zero.
inline Stamp fromRosTime(const ros::Time& time) {
  return time.isZero() ? kNoStamp : static_cast<Stamp>(time.toNSec());
}

/// [s] from one time to another. A ros::Duration may be too short for it.
inline double secondsBetween(const ros::Time& from, const ros::Time& to) {
  return to.toSec() - from.toSec();
}

}  // namespace rgbd_sfm_fusion
