// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "input_watch.h"

#include <ros/console.h>

#include <utility>

namespace rgbd_sfm_fusion {
namespace {

constexpr double kPeriod = 5.0;  // [s]
constexpr std::size_t kLooksPerReminder = 6;

}  // namespace

InputWatch::InputWatch(const ros::NodeHandle& handle, CallbackGuard* guard, std::string owner)
    : owner_(std::move(owner)), handle_(handle) {
  timer_ = handle_.createWallTimer(ros::WallDuration(kPeriod),
                                   guard->forEvents<ros::WallTimerEvent>("input watch", [this] { look(); }));
}

std::size_t InputWatch::add(const std::string& name, const std::string& consequence,
                            std::function<std::uint32_t()> publishers) {
  topics_.push_back({name, consequence, std::move(publishers)});
  return topics_.size() - 1;
}

std::size_t InputWatch::addNeededOnce(const std::string& name, const std::string& consequence,
                                      std::function<std::uint32_t()> publishers) {
  const std::size_t index = add(name, consequence, std::move(publishers));
  topics_[index].is_needed_once = true;
  return index;
}

void InputWatch::look() {
  std::string missing, ended, back;
  const bool reminds = looks_++ % kLooksPerReminder == 0;
  for (Topic& topic : topics_) {
    const bool was_silent = topic.is_silent;
    topic.has_come = topic.has_come || topic.received > 0;
    topic.is_silent = topic.received == 0 && !(topic.is_needed_once && topic.has_come);
    topic.received = 0;
    if (topic.is_silent && !topic.has_come && (reminds || !was_silent)) missing += "\n  " + describe(topic);
    if (topic.is_silent && topic.has_come && !was_silent) ended += "\n  " + describe(topic);
    if (!topic.is_silent && was_silent) back += (back.empty() ? " " : ", ") + topic.name;
  }
  if (!missing.empty()) ROS_WARN_STREAM(owner_ << ": no data for 5 seconds on" << missing);
  if (!ended.empty()) ROS_INFO_STREAM(owner_ << ": input has ended on" << ended);
  if (!back.empty()) ROS_INFO_STREAM(owner_ << ": data comes on" << back);
}

std::string InputWatch::describe(const Topic& topic) const {
  const std::uint32_t publishers = topic.publishers();
  return topic.name + " (" + std::to_string(publishers) +
         (publishers == 1 ? " publisher): " : " publishers): ") + topic.consequence;
}

}  // namespace rgbd_sfm_fusion
