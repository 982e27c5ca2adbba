// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <sensor_msgs/Image.h>

#include <cstddef>
#include <deque>
#include <optional>
#include <string>

#include "callback_guard.h"
#include "image_subscription.h"

namespace rgbd_sfm_fusion {

/// Drops images that are older than `stamp`, or came before the image of that stamp: where time goes back,
/// what came before has later stamps, and would stay.
/// @param kept  so many images stay, whatever their stamps
void forgetBefore(const ros::Time& stamp, std::size_t kept, std::deque<sensor_msgs::ImageConstPtr>* images);

/// The last colour images. They are kept until the frames made of them are fused.
class ColourBuffer {
 public:
  void push(const sensor_msgs::ImageConstPtr& image);

  /// @return null if it is not there
  sensor_msgs::ImageConstPtr find(const ros::Time& stamp) const;
  /// True if the image of `stamp`, which is not there, may still come. Images come in order, so it may if all
  /// images so far are older.
  bool mayCome(const ros::Time& stamp) const;

  bool empty() const { return images_.empty(); }
  void forgetOlderThan(const ros::Time& stamp) { forgetBefore(stamp, 0, &images_); }
  /// The same, but keeps the last image, which tells what may still come.
  void keepFrom(const ros::Time& stamp) { forgetBefore(stamp, 1, &images_); }
  void clear() { images_.clear(); }

 private:
  std::deque<sensor_msgs::ImageConstPtr> images_;
};

/// Subscribes to colour images only while somebody wants them.
class ColourInput {
 public:
  /// @param handle    resolves `rgb/image_raw`
  /// @param guard     of the callback
  /// @param on_image  called with each image
  ColourInput(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle, CallbackGuard* guard,
              ImageSubscription::OnImage on_image);

  void setWanted(bool wanted);

 private:
  ros::NodeHandle handle_, private_handle_;
  CallbackGuard* guard_;
  std::string topic_;
  ImageSubscription::OnImage on_image_;
  std::optional<ImageSubscription> subscription_;
};

}  // namespace rgbd_sfm_fusion
