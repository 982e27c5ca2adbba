// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "rgbd_sfm_fusion/fusion/fusion_options.h"
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// The keyframe before the current one. A new keyframe has few estimates of its own, so SfM depth would have
/// gaps. The last map of the keyframe before is brought into the new keyframe once. It is used where the new
/// keyframe has no depth and hides nothing.
class PreviousKeyframe {
 public:
  /// Depth of a tracked frame's keyframe, with gaps filled from the keyframe before.
  /// @param tracked   tracking, against `keyframe`
  /// @return          tracker units; the keyframe's own image if there is nothing to add. Valid until the
  ///                  next call
  GaussianDepth complete(const TrackingResult& tracked, const std::shared_ptr<const KeyframeMap>& keyframe,
                         const PinholeCamera& camera, const ReprojectionOptions& options);

  /// Forgets both keyframes: the pose jumped, and does not continue that of earlier frames.
  void reset();

 private:
  std::shared_ptr<const KeyframeMap> current_;
  SE3 T_odom_current_;
  Matrix6 covariance_ = Matrix6::Zero();  ///< of the last frame's pose relative to the current keyframe

  GaussianDepth carried_;  ///< depth of the keyframe before, as seen from the current one; empty: none
  GaussianDepth completed_;
};

}  // namespace rgbd_sfm_fusion
