// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/odometry_messages.h"

#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/stamp.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kLongestGap = 0.3;           // [s] between frames whose velocity still holds
constexpr double kAcceleration = 2.0;         // [m/s²] of hand-held cameras: 0.6 to 2.5 r.m.s.
constexpr double kAngularAcceleration = 3.0;  // [rad/s²] the same: 1 to 2.7
constexpr double kAnySpeed = 10.0;            // [m/s] or [rad/s] if nothing is known of the camera

std_msgs::Header inFrame(std_msgs::Header header, const std::string& frame_id) {
  header.frame_id = frame_id;
  return header;
}

Matrix6 carried(const Matrix6& by, const Matrix6& covariance) {
  const Matrix6 carried = by * covariance * by.transpose();
  return 0.5 * (carried + carried.transpose());
}

/// Covariance of the pose relative to the frame before: left perturbation, axes of the frame. A pose's
/// covariance consists of its keyframe's, carried along, and of a part of its own.
Matrix6 covarianceOfStep(const TrackingResult& now, const TrackingResult& before, const SE3& T_now_before) {
  const Matrix6 Ad = T_now_before.adjoint();
  const Matrix6 keyframe_part = carried(Ad, before.pose_covariance - before.covariance);
  return now.pose_covariance - keyframe_part + carried(Ad, before.covariance);
}

/// Covariance of the difference between the velocity at the end of an interval and its mean.
Matrix6 covarianceOfChange(double interval) {
  const double linear = 0.5 * interval * kAcceleration, angular = 0.5 * interval * kAngularAcceleration;
  Vector6 variances;
  variances << Eigen::Vector3d::Constant(linear * linear), Eigen::Vector3d::Constant(angular * angular);
  return variances.asDiagonal();
}

void write(const Matrix6& covariance, boost::array<double, 36>* field) {
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(field->data()) = covariance;
}

}  // namespace

SE3 opticalToBodyAxes() {
  return {Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), Eigen::Vector3d::Zero()};
}

bool hasBodyAxes(const std::string& frame, const std::string& base_frame,
                 const std::optional<SE3>& T_base_frame) {
  constexpr double kTurned = 0.5;  // [rad]
  if (frame.empty() || frame.find("optical") != std::string::npos) return false;
  if (frame == base_frame) return true;
  return T_base_frame && T_base_frame->log().tail<3>().norm() < kTurned;
}

geometry_msgs::PoseStamped toPoseMessage(const std_msgs::Header& header, const std::string& odom_frame,
                                         const SE3& T_odom_camera) {
  geometry_msgs::PoseStamped message;
  message.header = inFrame(header, odom_frame);
  message.pose = toPose(T_odom_camera);
  return message;
}

CameraVelocity velocityOf(const TrackingResult& now, const std::optional<TrackingResult>& before) {
  const double interval = before ? toSeconds(now.stamp - before->stamp) : 0.0;
  if (!(interval > 0.0 && interval <= kLongestGap) || now.relocalised)
    return {Vector6::Zero(), kAnySpeed * kAnySpeed * Matrix6::Identity()};
  const SE3 T_before_now = before->T_first_frame.inverse() * now.T_first_frame;
  const Matrix6 step = covarianceOfStep(now, *before, T_before_now.inverse());
  return {T_before_now.log() / interval, step / (interval * interval) + covarianceOfChange(interval)};
}

CameraVelocity VelocityEstimator::next(const TrackingResult& tracked) {
  const bool is_tracked = tracked.state == TrackingState::kTracking;
  const CameraVelocity velocity = velocityOf(tracked, is_tracked ? before_ : std::nullopt);
  before_ = is_tracked ? std::make_optional(tracked) : std::nullopt;
  return velocity;
}

nav_msgs::Odometry toOdometryMessage(const std_msgs::Header& header, const OdomPlace& place,
                                     const TrackingResult& tracked, const CameraVelocity& velocity) {
  const SE3 T_odom_base = place.T_odom_first * tracked.T_first_frame * place.T_base_camera.inverse();
  const Matrix6 to_base = place.T_base_camera.adjoint();
  Matrix6 to_odom_axes = Matrix6::Zero();
  to_odom_axes.topLeftCorner<3, 3>() = to_odom_axes.bottomRightCorner<3, 3>() = T_odom_base.rotationMatrix();
  const Vector6 twist = to_base * velocity.twist;

  nav_msgs::Odometry message;
  message.header = inFrame(header, place.odom_frame);
  message.child_frame_id = place.base_frame;
  message.pose.pose = toPose(T_odom_base);
  write(carried(to_odom_axes * to_base, tracked.pose_covariance), &message.pose.covariance);
  message.twist.twist.linear.x = twist(0);
  message.twist.twist.linear.y = twist(1);
  message.twist.twist.linear.z = twist(2);
  message.twist.twist.angular.x = twist(3);
  message.twist.twist.angular.y = twist(4);
  message.twist.twist.angular.z = twist(5);
  write(carried(to_base, velocity.covariance), &message.twist.covariance);
  return message;
}

}  // namespace rgbd_sfm_fusion
