// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "input_watch.h"

#include <ros/console.h>

#include <utility>

namespace rgbd_sfm_fusion {
namespace {

constexpr double kPeriod = 5.0;  // [s]

}  // namespace

InputWatch::InputWatch(const ros::NodeHandle& handle, std::string owner)
    : owner_(std::move(owner)), handle_(handle) {
  timer_ =
      handle_.createWallTimer(ros::WallDuration(kPeriod), [this](const ros::WallTimerEvent&) { look(); });
}

std::size_t InputWatch::add(const std::string& name, const std::string& consequence,
                            std::function<std::uint32_t()> publishers) {
  topics_.push_back({name, consequence, std::move(publishers), 0});
  return topics_.size() - 1;
}

void InputWatch::look() {
  std::string silent;
  for (Topic& topic : topics_) {
    if (topic.received == 0) {
      const std::uint32_t publishers = topic.publishers();
      silent += "\n  " + topic.name + " (" + std::to_string(publishers) +
                (publishers == 1 ? " publisher): " : " publishers): ") + topic.consequence;
    }
    topic.received = 0;
  }
  if (!silent.empty()) ROS_WARN_STREAM(owner_ << ": did not receive data since 5 seconds on" << silent);
}

}  // namespace rgbd_sfm_fusion
