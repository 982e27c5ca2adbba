// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/camera_pose.h"

namespace rgbd_sfm_fusion {

CameraPose CameraPose::then(const SE3& T_other_camera, const Matrix6& relative_covariance) const {
  const Matrix6 Ad = T_other_camera.adjoint();
  return {T_first_camera * T_other_camera.inverse(), Ad * covariance * Ad.transpose() + relative_covariance};
}

Matrix6 poseCovariance(const AlignmentResult& aligned, double scale_sigma) {
  Vector6 by_scale = Vector6::Zero();
  by_scale.head<3>() = scale_sigma * aligned.T_frame_keyframe.translation();
  return aligned.covariance + by_scale * by_scale.transpose();
}

}  // namespace rgbd_sfm_fusion
