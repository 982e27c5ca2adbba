// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "odom_frame.h"

#include <ros/console.h>

#include <stdexcept>
#include <utility>

#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/odometry_messages.h"

namespace rgbd_sfm_fusion {

OdomFrame::OdomFrame(std::string odom_frame, std::string base_frame, bool publish_tf)
    : odom_frame_(std::move(odom_frame)),
      base_frame_(std::move(base_frame)),
      publish_tf_(publish_tf),
      listener_(buffer_) {}

void OdomFrame::update(const std_msgs::Header& header, const SE3& T_first_camera) {
  place(header.frame_id, T_first_camera);
  if (!publish_tf_ || child_frame_.empty()) return;
  const SE3 T_odom_camera = T_odom_first() * T_first_camera;
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = header.stamp;
  transform.header.frame_id = odom_frame_;
  transform.child_frame_id = child_frame_;
  transform.transform =
      toTransform(T_base_camera_ ? T_odom_camera * T_base_camera_->inverse() : T_odom_camera);
  broadcaster_.sendTransform(transform);
}

void OdomFrame::place(const std::string& optical_frame, const SE3& T_first_camera) {
  const bool placed_on_base = T_odom_first_ && T_base_camera_;
  if (placed_on_base) return;
  T_base_camera_ = lookUpBase(optical_frame);
  if (T_odom_first_ && !T_base_camera_) return;
  if (T_odom_first_) {
    ROS_WARN_STREAM("tf from " << base_frame_ << " to " << optical_frame << " came late: the " << odom_frame_
                               << " frame is moved to the base frame's pose");
  }
  const SE3 T_odom_camera = T_base_camera_ ? *T_base_camera_ : opticalToBodyAxes();
  T_odom_first_ = T_odom_camera * T_first_camera.inverse();
  child_frame_ = T_base_camera_ ? base_frame_ : optical_frame;
  if (child_frame_.empty()) {
    ROS_WARN("images have no frame_id: no tf is published");
  } else if (publish_tf_ && hasForeignParent(child_frame_)) {
    ROS_WARN_STREAM(
        "tf frame " << child_frame_ << " has a parent already: no tf from " << odom_frame_
                    << " is published; set base_frame to the root above the camera, or publish_tf to "
                       "false");
    child_frame_.clear();
  }
}

std::optional<SE3> OdomFrame::lookUpBase(const std::string& optical_frame) const {
  if (base_frame_.empty() || optical_frame.empty()) return std::nullopt;
  try {
    return fromTransform(buffer_.lookupTransform(base_frame_, optical_frame, ros::Time(0)).transform);
  } catch (const tf2::TransformException&) {  // the usual case with bags
    return std::nullopt;
  } catch (const std::invalid_argument& error) {
    ROS_WARN_STREAM_THROTTLE(5, "tf from " << base_frame_ << " to " << optical_frame << ": " << error.what());
    return std::nullopt;
  }
}

bool OdomFrame::hasForeignParent(const std::string& frame) const {
  std::string parent;
  return buffer_._getParent(frame, ros::Time(0), parent) && parent != odom_frame_;
}

}  // namespace rgbd_sfm_fusion
