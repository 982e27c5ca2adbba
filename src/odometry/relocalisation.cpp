// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/relocalisation.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::size_t kMaxKeyframes = 10;  // 1 MB each
constexpr double kMinShareInView = 0.5;    // of a keyframe's points, to recognise it
constexpr double kMaxGain = 2.5;  // of brightness, either way: without limit anything fits a dark image

}  // namespace

std::vector<SE3> turned(const SE3& T_camera_world) {
  constexpr double kTurn = 0.1;  // [rad] coarse levels find the rest
  std::vector<SE3> poses{T_camera_world};
  for (int x = -2; x <= 2; ++x) {
    for (int y = -2; y <= 2; ++y) {
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
  if (keyframes_.size() == kMaxKeyframes) keyframes_.pop_front();
  keyframes_.push_back({keyframe.pointsOnly(), T_odom_keyframe});
}

std::optional<SE3> RecentKeyframes::findTOdomFrame(const ImagePyramid& image,
                                                   const TrackingOptions& options) const {
  const std::vector<SE3> starts = turned(SE3());
  std::optional<SE3> T_odom_frame;
  double most_in_view = 0.0;
  for (const Keyframe& keyframe : keyframes_) {
    const AlignmentResult result =
        align(keyframe.reference, image, starts, Brightness(), FrameShutter(), options);
    if (!isRecognised(result, options) || result.share_in_view <= most_in_view) continue;
    most_in_view = result.share_in_view;
    T_odom_frame = keyframe.T_odom_keyframe * result.T_frame_keyframe.inverse();
  }
  return T_odom_frame;
}

}  // namespace rgbd_sfm_fusion
