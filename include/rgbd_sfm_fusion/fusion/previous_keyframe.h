// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "rgbd_sfm_fusion/fusion/fusion_options.h"
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// The keyframe before the current one, so that a new keyframe, which has few estimates of its own, does not
/// leave SfM depth with gaps: its last map is brought into the new keyframe once, and used where that has
/// nothing and hides nothing.
class PreviousKeyframe {
 public:
  /// Depth of the keyframe of a tracked frame, completed by the keyframe's before.
  /// @param tracked   tracking, against `keyframe`
  /// @return          tracker units; the keyframe's own image where there is nothing to add. Valid until the
  /// next
  ///                  call
  GaussianDepth complete(const TrackingResult& tracked, const std::shared_ptr<const KeyframeMap>& keyframe,
                         const PinholeCamera& camera, const ReprojectionOptions& options);

  /// No frame after this one sees what was before it: tracking was lost, or jumped.
  void reset();

 private:
  std::shared_ptr<const KeyframeMap> current_;
  SE3 T_odom_current_;
  Matrix6 covariance_ = Matrix6::Zero();  ///< of the last frame's pose relative to the current keyframe

  GaussianDepth carried_;  ///< of the keyframe before, as seen from the current one; empty: nothing
  GaussianDepth completed_;
};

}  // namespace rgbd_sfm_fusion
