// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/odometry/keyframe.h"
#include "rgbd_sfm_fusion/tracking/direct_alignment.h"

namespace rgbd_sfm_fusion {

/// Poses that alignment starts from after a loss: the given pose, and poses turned up, down and sideways by
/// up to `steps` times 0.1 rad. The camera turns in its place, and about the point that it looks at.
/// @param depth  distance of the point that the camera looks at
std::vector<SE3> turned(const SE3& T_camera_world, int steps, double depth);

/// Whether an aligned frame shows what the keyframe shows: the brightness of most points fits, in about the
/// same light.
bool fits(const AlignmentResult& result, const TrackingOptions& options);

/// Like fits(), but stricter, for use after a loss: enough of the keyframe has to be in view, more points
/// have to fit, and the light has to be more alike.
bool isRecognised(const AlignmentResult& result, const TrackingOptions& options);

/// The keyframes before the present one, for a camera that comes back to one of them after a loss.
class RecentKeyframes {
 public:
  void remember(const TrackedKeyframe& keyframe);
  void clear() { keyframes_.clear(); }

  /// The image's pose, if the image shows one of the keyframes. A call looks at two keyframes, which takes as
  /// long as tracking half a dozen frames. The next call looks at the next two, from the latest to the oldest
  /// and round again.
  std::optional<OdomPose> find(const ImagePyramid& image, const TrackingOptions& options);

 private:
  /// What recognising a keyframe takes.
  struct Known {
    OdomPose pose;
    double inverse_depth;
    TrackingReference reference;
  };

  std::deque<Known> keyframes_;  // the latest first
  std::size_t next_ = 0;         // the next one to look at
};

}  // namespace rgbd_sfm_fusion
