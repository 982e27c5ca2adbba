// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <std_msgs/Header.h>
#include <tf2/buffer_core.h>
#include <tf2_ros/transform_broadcaster.h>

#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/ros/odometry_messages.h"
#include "tf_listener.h"

namespace rgbd_sfm_fusion {

/// The odom frame: where it lies, and tf from it to the camera.
///
/// It is the base frame's pose at the start, if tf knows how the camera sits on the base. Where the image's
/// frame has no parent (bags), it is the camera's position at the start, with REP 103's axes.
///
/// If somebody else publishes a parent of the frame that it would move, or moves a frame in `odom`, it says
/// so once for each, and broadcasts nothing from then on. In the second case `odom` belongs to somebody else,
/// and no pose is published in it.
class OdomFrame {
 public:
  OdomFrame(const ros::NodeHandle& handle, CallbackGuard* guard, std::string odom_frame,
            std::string base_frame, bool publish_tf);

  /// Whether somebody else moves frames in a frame named like ours. Our poses would then be taken for poses
  /// in that frame.
  bool isForeign() const;

  /// The next pose is the first one.
  void restart();

  /// Takes a tracked frame's pose, and broadcasts it. To be called from one thread.
  /// @param header          of the colour image
  /// @param T_first_camera  from the camera's optical axes to those of the first tracked image
  void update(const std_msgs::Header& header, const SE3& T_first_camera);

  /// As of the last update.
  OdomPlace place() const;

 private:
  /// Takes a transform that was published by somebody else.
  struct ForeignParent {
    std::string parent;
    std::string publisher;
  };

  void observe(const geometry_msgs::TransformStamped& transform, const std::string& publisher);
  void findPlace(const std::string& optical_frame, const SE3& T_first_camera);
  void sayWhoElse();
  std::optional<SE3> lookUpBase(const std::string& optical_frame) const;
  std::optional<ForeignParent> foreignParentOf(const std::string& frame) const;

  std::string odom_frame_;
  std::string base_frame_;
  bool publish_tf_;

  mutable std::mutex mutex_;                      ///< guards the next three
  std::map<std::string, ForeignParent> foreign_;  ///< by child
  std::optional<std::string> moves_odom_;         ///< who else publishes children of odom
  std::set<std::string> moved_;                   ///< frames that were broadcast from here

  tf2::BufferCore buffer_;
  tf2_ros::TransformBroadcaster broadcaster_;
  TfListener listener_;

  std::optional<SE3> T_odom_first_;
  std::optional<SE3> T_base_camera_;  ///< nothing: the image's frame hangs on odom itself
  std::string child_frame_;           ///< of the tf; empty: images have no frame
  bool has_said_axes_ = false;        ///< of the images' frame, in this run
  bool has_said_odom_ = false;        ///< who else moves frames in it
  std::string said_parent_of_;        ///< the frame of which it was said who else publishes its parent
};

}  // namespace rgbd_sfm_fusion
