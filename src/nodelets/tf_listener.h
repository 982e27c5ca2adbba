// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <tf2/buffer_core.h>
#include <tf2_msgs/TFMessage.h>

#include <functional>
#include <mutex>
#include <string>

#include "callback_guard.h"

namespace rgbd_sfm_fusion {

/// Fills a buffer from /tf and /tf_static, as tf2_ros::TransformListener does. That one ends the process if a
/// stamp is so late that ten seconds more cannot be represented. Here, the publisher's name is known, too.
class TfListener {
 public:
  using Observer = std::function<void(const geometry_msgs::TransformStamped&, const std::string& publisher)>;

  /// @param observer  is shown each transform, in the callback's thread
  TfListener(const ros::NodeHandle& handle, CallbackGuard* guard, tf2::BufferCore* buffer, Observer observer);

 private:
  using Event = ros::MessageEvent<const tf2_msgs::TFMessage>;

  void receive(const Event& event, bool is_static);

  CallbackGuard* guard_;
  tf2::BufferCore* buffer_;
  Observer observer_;
  ros::Time last_;
  ros::Subscriber moving_, static_;
};

}  // namespace rgbd_sfm_fusion
