// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nav_msgs/Path.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>

#include "odom_frame.h"
#include "rgbd_sfm_fusion/ros/odometry_messages.h"

namespace rgbd_sfm_fusion {

/// ~pose and ~path, the camera in the odom frame, and ~odometry, the base frame in it: for every tracked
/// frame, unless the odom frame is somebody else's.
class PosePublisher {
 public:
  explicit PosePublisher(const ros::NodeHandle& private_handle);

  /// Takes every result: what is not tracked is not published, but ends the motion so far.
  /// @param header  of the colour image
  void publish(const std_msgs::Header& header, const TrackingResult& tracked, const OdomFrame& odom);

  /// Starts a new path.
  void restart();

 private:
  ros::Publisher pose_publisher_;
  ros::Publisher odometry_publisher_;
  ros::Publisher path_publisher_;
  nav_msgs::Path path_;
  VelocityEstimator velocities_;
};

}  // namespace rgbd_sfm_fusion
