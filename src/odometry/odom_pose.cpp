// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/odom_pose.h"

namespace rgbd_sfm_fusion {
namespace {

// Errors that all of a keyframe's depths share. Sensors have a scale error of 0.5 % (Khoshelham & Elberink
// 2012). Stereo adds as much, or drifts by as much without the sensor. Both numbers were chosen on rendered
// seeds 101 to 103. Relative poses have a NEES / 6 of about 1 there with the sensor's depth, and of 3 to 5
// without it. scripts/evaluate prints the NEES as "pose in keyframe".
constexpr double kScaleSigma = 0.0075;
constexpr double kOffsetSigma = 0.004;  // of the mean inverse depth

}  // namespace

OdomPose OdomPose::then(const SE3& T_other_camera, const Matrix6& relative_covariance) const {
  const Matrix6 Ad = T_other_camera.adjoint();
  return {T_odom_camera * T_other_camera.inverse(), Ad * covariance * Ad.transpose() + relative_covariance};
}

Matrix6 poseCovariance(const AlignmentResult& aligned, double inverse_depth) {
  const Eigen::Vector3d t = aligned.T_frame_keyframe.translation();
  Vector6 by_scale = Vector6::Zero(), by_offset = Vector6::Zero();
  by_scale.head<3>() = kScaleSigma * t;
  // If inverse depths are too large by b, pixels move farther by f b (t_x, t_y), as they would in a turn.
  by_offset.tail<3>() = kOffsetSigma * inverse_depth * Eigen::Vector3d(-t.y(), t.x(), 0.0);
  return aligned.covariance + by_scale * by_scale.transpose() + by_offset * by_offset.transpose();
}

}  // namespace rgbd_sfm_fusion
