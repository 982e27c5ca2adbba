// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nav_msgs/Path.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>

#include "odom_frame.h"
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"

namespace rgbd_sfm_fusion {

/// ~pose, ~odometry and ~path: the camera in the odom frame, for every tracked frame.
class PosePublisher {
 public:
  explicit PosePublisher(const ros::NodeHandle& private_handle);

  /// @param header  of the colour image
  void publish(const std_msgs::Header& header, const TrackingResult& tracked, const OdomFrame& odom);

  /// Starts a new path.
  void restart() { path_.poses.clear(); }

 private:
  ros::Publisher pose_publisher_;
  ros::Publisher odometry_publisher_;
  ros::Publisher path_publisher_;
  nav_msgs::Path path_;
};

}  // namespace rgbd_sfm_fusion
