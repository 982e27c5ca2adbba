// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/tracking/direct_alignment.h"

namespace rgbd_sfm_fusion {

/// A pose, and that of a camera turned up, down and sideways from there, by up to `steps` times 0.1 rad:
/// where alignment starts from after a loss.
std::vector<SE3> turned(const SE3& T_camera_world, int steps);

/// Whether an aligned frame shows what the keyframe shows: most of its points' brightness fits, in about the
/// same light.
bool fits(const AlignmentResult& result, const TrackingOptions& options);

/// As fits(), after a loss: enough of the keyframe has to be in view, too.
bool isRecognised(const AlignmentResult& result, const TrackingOptions& options);

/// The keyframes before the present one, for a camera that comes back to one of them after a loss.
class RecentKeyframes {
 public:
  void remember(const TrackingReference& keyframe, const SE3& T_odom_keyframe);
  void clear() { keyframes_.clear(); }

  /// The frame's pose, if it shows one of the keyframes. Looks at two of them, which takes as long as half a
  /// dozen frames' tracking; the next call looks at the next two, from the latest to the oldest and round
  /// again.
  std::optional<SE3> findTOdomFrame(const ImagePyramid& image, const TrackingOptions& options);

 private:
  struct Keyframe {
    TrackingReference reference;
    SE3 T_odom_keyframe;
  };
  std::deque<Keyframe> keyframes_;  // the latest first
  std::size_t next_ = 0;            // to be looked at
};

}  // namespace rgbd_sfm_fusion
