// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Messages about poses for people and other packages, in the odom frame (REP 103 axes).
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <nav_msgs/Odometry.h>

#include <optional>
#include <string>

#include "rgbd_sfm_fusion/odometry/visual_odometry.h"

namespace rgbd_sfm_fusion {

constexpr char kDefaultOdomFrame[] = "odom";

/// From optical axes (x right, y down, z forward) to REP 103's (x forward, y left, z up).
SE3 opticalToBodyAxes();

/// Whether the frame_id of images names a frame with a body's axes (x forward), as Gazebo's does: it is the
/// base frame, or turned like it, and not named as an optical frame. Such a frame is not the optical frame in
/// tf.
/// @param T_base_frame  nothing: tf does not have it
bool hasBodyAxes(const std::string& frame, const std::string& base_frame,
                 const std::optional<SE3>& T_base_frame);

/// Pose of the camera's optical frame.
/// @param header  of the colour image
geometry_msgs::PoseStamped toPoseMessage(const std_msgs::Header& header, const std::string& odom_frame,
                                         const SE3& T_odom_camera);

/// Velocity of the camera, in its own optical axes.
struct CameraVelocity {
  Vector6 twist = Vector6::Zero();       ///< [m/s, rad/s]
  Matrix6 covariance = Matrix6::Zero();  ///< never singular; as good as infinite where nothing is known
};

/// Velocity at the time of `now`: the mean velocity since `before`. Its covariance includes the change by
/// acceleration in that time. Two poses against one keyframe are taken to have independent errors, as the
/// errors that they share cancel.
/// @param now     a tracked frame
/// @param before  the frame before, if it was tracked, too; nothing: the velocity is unknown, e.g. after a
///                 gap or a jump
CameraVelocity velocityOf(const TrackingResult& now, const std::optional<TrackingResult>& before);

/// Velocities of successive frames.
class VelocityEstimator {
 public:
  /// Takes every result. One that is not tracked ends the motion so far.
  CameraVelocity next(const TrackingResult& tracked);

  /// Forgets the last frame, so that the next one has none before it.
  void restart() { before_.reset(); }

 private:
  std::optional<TrackingResult> before_;  ///< if it was tracked
};

/// The moving frame and its place, by tf.
struct OdomPlace {
  std::string odom_frame;
  std::string base_frame;  ///< the images' own frame, if no other is known
  SE3 T_odom_first;        ///< from the optical axes of the first tracked image
  SE3 T_base_camera;       ///< the identity for the images' own frame
};

/// Odometry as nav_msgs/Odometry defines it, and as filters read it. It has the pose of the base frame in the
/// odom frame. The pose's covariance is about the position itself, with the axes of the odom frame
/// (TrackingResult::pose_covariance, carried to the base). Velocity and its covariance are in the base
/// frame's own axes.
nav_msgs::Odometry toOdometryMessage(const std_msgs::Header& header, const OdomPlace& place,
                                     const TrackingResult& tracked, const CameraVelocity& velocity);

}  // namespace rgbd_sfm_fusion
