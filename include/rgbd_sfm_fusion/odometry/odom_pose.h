// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/geometry/se3.h"

namespace rgbd_sfm_fusion {

/// A pose of the camera, and how well it is known.
struct OdomPose {
  SE3 T_odom_camera;
  Matrix6 covariance = Matrix6::Zero();  ///< of its inverse: left perturbation, axes of the camera

  /// Of another pose, seen from this one.
  /// @param relative_covariance  of T_other_camera: left perturbation, axes of the other
  OdomPose then(const SE3& T_other_camera, const Matrix6& relative_covariance) const;
};

/// A pose relative to a keyframe.
struct RelativePose {
  SE3 T_frame_keyframe;
  Matrix6 covariance = Matrix6::Zero();  ///< left perturbation, axes of the frame

  /// The same frame's, relative to another frame that was seen from the same keyframe.
  RelativePose relativeTo(const RelativePose& other) const;
};

/// Covariance of an aligned pose: alignment's, and what errors do that all of a keyframe's depths share, and
/// that no image shows: of their scale to the way from there, and an offset, as a turn that looks like it.
/// @param aligned        with alignment's covariance
/// @param inverse_depth  of what the keyframe shows, on average
Matrix6 poseCovariance(const RelativePose& aligned, double inverse_depth);

}  // namespace rgbd_sfm_fusion
