// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// What is published of poses for people and other packages, in the odom frame (REP 103 axes).
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <nav_msgs/Odometry.h>

#include <string>

#include "rgbd_sfm_fusion/odometry/visual_odometry.h"

namespace rgbd_sfm_fusion {

constexpr char kDefaultOdomFrame[] = "odom";

/// From optical axes (x right, y down, z forward) to REP 103's (x forward, y left, z up).
SE3 opticalToBodyAxes();

/// Pose of the camera's optical frame.
/// @param header        of the colour image
/// @param T_odom_first  from the optical frame of the first tracked image to the odom frame
geometry_msgs::PoseStamped toPoseMessage(const std_msgs::Header& header, const std::string& odom_frame,
                                         const SE3& T_odom_camera);

/// The same with covariance: of the pose since the start (TrackingResult::odom_covariance), turned from
/// the camera's axes to those of the odom frame. child_frame_id is the optical frame; there is no twist (its
/// covariance says so with -1, as is ROS's custom).
nav_msgs::Odometry toOdometryMessage(const std_msgs::Header& header, const std::string& odom_frame,
                                     const SE3& T_odom_camera, const Matrix6& frame_covariance);

}  // namespace rgbd_sfm_fusion
