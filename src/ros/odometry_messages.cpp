// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/odometry_messages.h"

#include "rgbd_sfm_fusion/ros/conversions.h"

namespace rgbd_sfm_fusion {
namespace {

std_msgs::Header inFrame(std_msgs::Header header, const std::string& frame_id) {
  header.frame_id = frame_id;
  return header;
}

}  // namespace

SE3 opticalToBodyAxes() {
  return {Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), Eigen::Vector3d::Zero()};
}

geometry_msgs::PoseStamped toPoseMessage(const std_msgs::Header& header, const std::string& odom_frame,
                                         const SE3& T_odom_camera) {
  geometry_msgs::PoseStamped message;
  message.header = inFrame(header, odom_frame);
  message.pose = toPose(T_odom_camera);
  return message;
}

nav_msgs::Odometry toOdometryMessage(const std_msgs::Header& header, const std::string& odom_frame,
                                     const SE3& T_odom_camera, const Matrix6& frame_covariance) {
  nav_msgs::Odometry message;
  message.header = inFrame(header, odom_frame);
  message.child_frame_id = header.frame_id;
  message.pose.pose = toPose(T_odom_camera);
  // ROS's pose covariance is about the position itself, with axes of the parent frame: only turn it.
  Matrix6 rotation = Matrix6::Zero();
  rotation.topLeftCorner<3, 3>() = rotation.bottomRightCorner<3, 3>() = T_odom_camera.rotationMatrix();
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(message.pose.covariance.data()) =
      rotation * frame_covariance * rotation.transpose();
  message.twist.covariance[0] = -1.0;
  return message;
}

}  // namespace rgbd_sfm_fusion
