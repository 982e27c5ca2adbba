// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "rgbd_sfm_fusion/fusion/fusion_options.h"
#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/image_pool.h"
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// A keyframe's depth as seen from another frame (paper, Eq. 5 to 7, with p' = R p + t; method.md 3).
///
/// Each point goes to the nearest pixel centre (`kNearest`). If several points fall on one pixel, the nearest
/// surface wins. If they are of one surface (closer than `same_surface` sigma), the point with the smaller σ
/// of inverse depth wins: their errors are correlated, and a mean would only pretend to know more. A pixel
/// between two neighbours of one surface may have no depth, or a depth behind that surface. It gets the
/// keyframe's depth that belongs there, if there is one. Variance: σ'² = (∂Z'/∂μ)² σ² + J Σ_pose Jᵀ + the
/// effect of rounding on slopes and at steps (lateral_variance.h).
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

/// Marks where the frame shows no texture: SfM has no depth there. The keyframe has depth at edges of its
/// image only. A point whose edge the frame does not show is hidden behind a surface that came before it.
/// Where that surface has no SfM depth of its own, as a dark screen, nothing else tells.
///
/// Where the sensor sees, it tells what is hidden. Depth stays there, and counts when errors are learned.
///
/// @param grey      of the frame
/// @param measured  1 where the sensor has depth, else 0
/// @param pool      lends work space
/// @param marked    of the same size; set to 1 where SfM's depth shines through
void markShineThrough(const GreyImage& grey, const cv::Mat_<std::uint8_t>& measured, ImagePool& pool,
                      cv::Mat_<std::uint8_t>& marked);

/// The keyframe before the current one. A new keyframe has few estimates of its own, so SfM depth would have
/// gaps. The last map of the keyframe before is brought into the new keyframe once. It is used where the new
/// keyframe has no depth and hides nothing.
class PreviousKeyframe {
 public:
  /// Depth of a tracked frame's keyframe, with gaps filled from the keyframe before.
  /// @param tracked   tracking, against `keyframe`
  /// @param pool      lends the images of the result
  /// @return          tracker units; the keyframe's own image if there is nothing to add
  GaussianDepth fillGaps(const TrackingResult& tracked, const std::shared_ptr<const KeyframeMap>& keyframe,
                         const ReprojectionOptions& options, ImagePool& pool);

  /// Forgets both keyframes: the pose jumped, and does not continue that of earlier frames.
  void reset();

 private:
  std::shared_ptr<const KeyframeMap> current_;
  SE3 T_first_current_;
  Matrix6 covariance_ = Matrix6::Zero();  ///< of the last frame's pose relative to the current keyframe

  GaussianDepth carried_;  ///< depth of the keyframe before, as seen from the current one; empty: none
};

}  // namespace rgbd_sfm_fusion
