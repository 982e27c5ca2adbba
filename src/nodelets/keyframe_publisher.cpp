// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "keyframe_publisher.h"

#include <geometry_msgs/PoseStamped.h>
#include <ros/single_subscriber_publisher.h>
#include <ros/this_node.h>
#include <sensor_msgs/CameraInfo.h>

#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/keyframe_messages.h"
#include "rgbd_sfm_fusion/ros/odometry_messages.h"
#include "rgbd_sfm_fusion/ros/tracker_messages.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::uint32_t kQueueSize = 10;

bool isLocal(const ros::SingleSubscriberPublisher& subscriber) {
  return subscriber.getSubscriberName() == ros::this_node::getName();
}

}  // namespace

KeyframePublisher::KeyframePublisher(const ros::NodeHandle& private_handle) {
  ros::NodeHandle handle(private_handle);
  keyframe_ = handle.advertise<Keyframe>(
      "keyframe", kQueueSize,
      [this](const ros::SingleSubscriberPublisher& s) { local_subscribers_ += isLocal(s) ? 1 : 0; },
      [this](const ros::SingleSubscriberPublisher& s) { local_subscribers_ -= isLocal(s) ? 1 : 0; });
  for (const KeyframeImageTopic& topic : keyframeImageTopics()) {
    images_.push_back(handle.advertise<sensor_msgs::Image>("keyframe/" + topic.name, kQueueSize));
  }
  camera_info_ = handle.advertise<sensor_msgs::CameraInfo>("keyframe/camera_info", kQueueSize);
  pose_ = handle.advertise<geometry_msgs::PoseStamped>("keyframe/pose", kQueueSize);
}

void KeyframePublisher::publish(const KeyframeMap& keyframe, const Context& context) {
  const std_msgs::Header its_header = keyframeHeader(context.header, keyframe);
  const bool due = isDue(keyframe);
  if (keyframe_.getNumSubscribers() > 0 && (due || local_subscribers_ > 0)) {
    const KeyframePtr message = toMessage(its_header, keyframe, context.odom.T_odom_first);
    message->run = context.run;
    keyframe_.publish(message);
  }
  if (due) publishForPeople(its_header, keyframe, context);
}

/// A new keyframe always is: frames refer to it.
bool KeyframePublisher::isDue(const KeyframeMap& keyframe) {
  const ros::WallTime now = ros::WallTime::now();
  const bool due =
      keyframe.stamp != last_keyframe_ || (now - last_time_).toSec() >= 1.0 / rate_ || now < last_time_;
  if (due) {
    last_time_ = now;
    last_keyframe_ = keyframe.stamp;
  }
  return due;
}

void KeyframePublisher::publishForPeople(const std_msgs::Header& header, const KeyframeMap& keyframe,
                                         const Context& context) {
  for (std::size_t i = 0; i < images_.size(); ++i) {
    if (images_[i].getNumSubscribers() > 0)
      images_[i].publish(keyframeImageTopics()[i].make(header, keyframe));
  }
  if (camera_info_.getNumSubscribers() > 0) camera_info_.publish(toCameraInfo(header, context.camera));
  if (pose_.getNumSubscribers() > 0 && !context.is_odom_foreign) {
    const OdomPlace& place = context.odom;
    pose_.publish(toPoseMessage(header, place.odom_frame, place.T_odom_first * keyframe.T_first_keyframe));
  }
}

}  // namespace rgbd_sfm_fusion
