// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/tracking/direct_alignment.h"

namespace rgbd_sfm_fusion {

/// A pose of the camera's optical frame, and how well it is known. The frame that poses are in is the optical
/// frame of the first tracked image. It is not the frame `odom` of ROS, which has axes of its own
/// (OdomFrame).
struct CameraPose {
  SE3 T_first_camera;
  Matrix6 covariance = Matrix6::Zero();  ///< of T_camera_first: left perturbation, axes of the camera

  /// The pose of another camera that is given relative to this one.
  /// @param relative_covariance  of T_other_camera: left perturbation, axes of the other
  CameraPose then(const SE3& T_other_camera, const Matrix6& relative_covariance) const;
};

/// Covariance of an aligned pose: alignment's covariance, and the effect of an error of scale, which all of a
/// keyframe's depths share and no image shows. It changes the distance from the keyframe.
/// @param scale_sigma  [1] standard deviation of that scale: that of the sensor, from which the scale is
Matrix6 poseCovariance(const AlignmentResult& aligned, double scale_sigma);

}  // namespace rgbd_sfm_fusion
