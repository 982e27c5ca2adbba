// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/fusion/fusion_options.h"
#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// A keyframe's depth as seen from another frame (paper, Eq. 5 to 7, with p' = R p + t; method.md 3).
///
/// Each point goes to the nearest pixel centre. If several points fall on one pixel, the nearest surface
/// wins. If they are of one surface (closer than `same_surface` sigma), the point with the smaller σ of
/// inverse depth wins: their errors are correlated, and a mean would only pretend to know more. A pixel
/// between two neighbours of one surface may have no depth, or a depth behind that surface. It gets the
/// keyframe's depth that belongs there, if there is one. Variance: σ'² = (∂Z'/∂μ)² σ² + J Σ_pose Jᵀ + the
/// effect of rounding on slopes.
///
/// The identity (exactly) returns the same images. Scaling depth and translation scales the result.
///
/// @param keyframe          tracker units, H x W of `camera`
/// @param T_frame_keyframe  tracker units
/// @param pose_covariance   of T_frame_keyframe: left perturbation, axes of the frame, (x y z rx ry rz)
/// @param buffer            images of the right size are overwritten and returned
GaussianDepth reproject(const GaussianDepth& keyframe, const PinholeCamera& camera,
                        const SE3& T_frame_keyframe, const Matrix6& pose_covariance,
                        const ReprojectionOptions& options, GaussianDepth buffer = {});

}  // namespace rgbd_sfm_fusion
