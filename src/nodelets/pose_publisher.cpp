// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "pose_publisher.h"

#include "rgbd_sfm_fusion/ros/odometry_messages.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::uint32_t kQueueSize = 30;
constexpr std::size_t kLongestPath = 18000;  // ten minutes: a path is sent whole each time

}  // namespace

PosePublisher::PosePublisher(const ros::NodeHandle& private_handle) {
  ros::NodeHandle handle(private_handle);
  pose_publisher_ = handle.advertise<geometry_msgs::PoseStamped>("pose", kQueueSize);
  odometry_publisher_ = handle.advertise<nav_msgs::Odometry>("odometry", kQueueSize);
  path_publisher_ = handle.advertise<nav_msgs::Path>("path", kQueueSize);
}

void PosePublisher::publish(const std_msgs::Header& header, const TrackingResult& tracked,
                            const OdomFrame& odom) {
  const CameraVelocity velocity = velocities_.next(tracked);
  if (tracked.state != TrackingState::kTracking || odom.isForeign()) return;
  const OdomPlace place = odom.place();
  const geometry_msgs::PoseStamped pose =
      toPoseMessage(header, place.odom_frame, place.T_odom_first * tracked.T_first_frame);
  if (pose_publisher_.getNumSubscribers() > 0) pose_publisher_.publish(pose);
  if (odometry_publisher_.getNumSubscribers() > 0)
    odometry_publisher_.publish(toOdometryMessage(header, place, tracked, velocity));
  if (path_.poses.size() >= kLongestPath) path_.poses.erase(path_.poses.begin());
  path_.poses.push_back(pose);
  path_.header = pose.header;
  if (path_publisher_.getNumSubscribers() > 0) path_publisher_.publish(path_);
}

void PosePublisher::restart() {
  path_.poses.clear();
  velocities_.restart();
}

}  // namespace rgbd_sfm_fusion
