// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/odometry/keyframe.h"
#include "rgbd_sfm_fusion/tracking/direct_alignment.h"

namespace rgbd_sfm_fusion {

/// A pose, and that of a camera turned up, down and sideways from there, by up to `steps` times 0.1 rad, in
/// its place and about what it looks at: where alignment starts from after a loss.
/// @param depth  of what it looks at
std::vector<SE3> turned(const SE3& T_camera_world, int steps, double depth);

/// Whether an aligned frame shows what the keyframe shows: most of its points' brightness fits, in about the
/// same light.
bool fits(const AlignmentResult& result, const TrackingOptions& options);

/// As fits(), after a loss: enough of the keyframe has to be in view, too.
bool isRecognised(const AlignmentResult& result, const TrackingOptions& options);

/// The keyframes before the present one, for a camera that comes back to one of them after a loss.
class RecentKeyframes {
 public:
  void remember(std::shared_ptr<const TrackedKeyframe> keyframe);
  void clear() { keyframes_.clear(); }

  /// The frame's pose, if it shows one of the keyframes, which are about `depth` from what they show. Looks
  /// at two of them, which takes as long as half a dozen frames' tracking; the next call looks at the next
  /// two, from the latest to the oldest and round again.
  std::optional<OdomPose> find(const ImagePyramid& image, double depth, const TrackingOptions& options);

 private:
  std::deque<std::shared_ptr<const TrackedKeyframe>> keyframes_;  // the latest first
  std::size_t next_ = 0;                                          // to be looked at
};

}  // namespace rgbd_sfm_fusion
