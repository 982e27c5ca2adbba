// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <std_msgs/Header.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_broadcaster.h>
#include <tf2_ros/transform_listener.h>

#include <optional>
#include <string>

#include "rgbd_sfm_fusion/geometry/se3.h"

namespace rgbd_sfm_fusion {

/// The odom frame: where it lies, and tf from it to the camera.
///
/// It is the base frame's pose at the start, if tf knows how the camera sits on the base. Where the image's
/// frame has no parent (bags), it is the camera's position at the start, with REP 103's axes.
class OdomFrame {
 public:
  OdomFrame(std::string odom_frame, std::string base_frame, bool publish_tf);

  const std::string& name() const { return odom_frame_; }

  /// The next pose is the first one.
  void restart() { T_odom_first_.reset(); }

  /// Takes a tracked frame's pose, and broadcasts it.
  /// @param header          of the colour image
  /// @param T_first_camera  from the camera's optical axes to those of the first tracked image
  void update(const std_msgs::Header& header, const SE3& T_first_camera);

  /// From the optical axes of the first tracked image to the odom frame, as of the last update.
  SE3 T_odom_first() const { return T_odom_first_.value_or(SE3()); }

 private:
  void place(const std::string& optical_frame, const SE3& T_first_camera);
  std::optional<SE3> lookUpBase(const std::string& optical_frame) const;
  bool hasForeignParent(const std::string& frame) const;

  std::string odom_frame_;
  std::string base_frame_;
  bool publish_tf_;
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
  tf2_ros::TransformBroadcaster broadcaster_;

  std::optional<SE3> T_odom_first_;
  std::optional<SE3> T_base_camera_;  ///< nothing: the image's frame hangs on odom itself
  std::string child_frame_;           ///< of the tf; empty: none is published
};

}  // namespace rgbd_sfm_fusion
