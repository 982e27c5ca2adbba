// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "callback_guard.h"

#include <ros/console.h>

namespace rgbd_sfm_fusion {
namespace {

constexpr double kUntilTheSame = 5.0;  // [s]
constexpr double kUntilOther = 1.0;    // [s]

}  // namespace

void CallbackGuard::report(const std::string& source, const std::string& reason) noexcept {
  const Lock lock(mutex_);
  try {
    if (handler_) handler_(source + ": " + reason);
    const ros::WallTime now = ros::WallTime::now();
    const auto said = last_said_.find(source);
    if (said != last_said_.end()) {
      const double pause = said->second.reason == reason ? kUntilTheSame : kUntilOther;
      if ((now - said->second.time).toSec() < pause) return;
    }
    last_said_[source] = {reason, now};
    ROS_ERROR_STREAM(owner_ << ": " << source << ": " << reason);
  } catch (...) {  // not even memory to say it with: the next one may be said
  }
}

}  // namespace rgbd_sfm_fusion
