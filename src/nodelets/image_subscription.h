// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <sensor_msgs/Image.h>

#include <cstdint>
#include <functional>
#include <string>

#include "callback_guard.h"

namespace rgbd_sfm_fusion {

/// Images of a topic as they are, or decoded from what image_transport's plug-ins send below it: the plug-ins
/// themselves are not needed.
class ImageSubscription {
 public:
  using OnImage = std::function<void(const sensor_msgs::ImageConstPtr&)>;

  /// @param parameter  private parameter with the transport: raw (if it is not set), compressed, or
  ///                   compressedDepth. Another one is said to be wrong, and raw is used
  /// @param on_image   called within the guard, which says of images that cannot be decoded why
  void subscribe(ros::NodeHandle& handle, const ros::NodeHandle& private_handle, const std::string& parameter,
                 const std::string& topic, std::uint32_t queue_size, CallbackGuard* guard, OnImage on_image);

  /// With the transport's name, if there is one.
  std::string getTopic() const { return subscriber_.getTopic(); }
  std::uint32_t getNumPublishers() const { return subscriber_.getNumPublishers(); }

 private:
  ros::Subscriber subscriber_;
};

}  // namespace rgbd_sfm_fusion
