// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/relocalisation.h"

#include <algorithm>

namespace rgbd_sfm_fusion {
namespace {

constexpr std::size_t kMaxKeyframes = 10;  // 1 MB each
constexpr std::size_t kAtATime = 2;
constexpr double kMinShareInView = 0.5;  // of a keyframe's points, to recognise it
constexpr double kMaxGain = 2.5;  // of brightness, either way: without limit anything fits a dark image

}  // namespace

std::vector<SE3> turned(const SE3& T_camera_world, int steps) {
  constexpr double kTurn = 0.1;  // [rad] coarse levels find the rest
  std::vector<SE3> poses{T_camera_world};
  for (int x = -steps; x <= steps; ++x) {
    for (int y = -steps; y <= steps; ++y) {
      if (x == 0 && y == 0) continue;
      Vector6 twist = Vector6::Zero();
      twist(3) = kTurn * x;
      twist(4) = kTurn * y;
      poses.push_back(SE3::exp(twist) * T_camera_world);
    }
  }
  return poses;
}

bool fits(const AlignmentResult& result, const TrackingOptions& options) {
  return result.converged && result.share_good >= static_cast<double>(options.min_share_of_good_points) &&
         result.brightness.gain < kMaxGain && result.brightness.gain > 1.0 / kMaxGain;
}

bool isRecognised(const AlignmentResult& result, const TrackingOptions& options) {
  return fits(result, options) && result.share_in_view >= kMinShareInView;
}

void RecentKeyframes::remember(const TrackingReference& keyframe, const SE3& T_odom_keyframe) {
  keyframes_.push_front({keyframe.pointsOnly(), T_odom_keyframe});
  if (keyframes_.size() > kMaxKeyframes) keyframes_.pop_back();
  next_ = 0;
}

std::optional<SE3> RecentKeyframes::findTOdomFrame(const ImagePyramid& image,
                                                   const TrackingOptions& options) {
  const std::vector<SE3> starts = turned(SE3(), 1);
  for (std::size_t i = 0; i < std::min(kAtATime, keyframes_.size()); ++i) {
    const Keyframe& keyframe = keyframes_[next_++ % keyframes_.size()];
    const AlignmentResult result =
        align(keyframe.reference, image, starts, Brightness(), FrameShutter(), options);
    if (isRecognised(result, options)) return keyframe.T_odom_keyframe * result.T_frame_keyframe.inverse();
  }
  return std::nullopt;
}

}  // namespace rgbd_sfm_fusion
