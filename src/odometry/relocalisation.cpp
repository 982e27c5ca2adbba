// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/relocalisation.h"

#include <algorithm>

namespace rgbd_sfm_fusion {
namespace {

constexpr std::size_t kMaxKeyframes = 10;  // 1 to 3 MB each
constexpr std::size_t kAtATime = 2;
constexpr double kMinShareInView = 0.5;  // of a keyframe's points, to recognise it
// One of many starts may end where half of the points fit by chance, or more of them in another light.
constexpr double kMinShareGood = 0.6;  // of the points in view
constexpr double kMaxGain = 1.6;       // of brightness, either way

}  // namespace

std::vector<SE3> turned(const SE3& T_camera_world, int steps, double depth) {
  constexpr double kTurn = 0.1;  // [rad] coarse levels find the rest
  std::vector<SE3> poses{T_camera_world};
  for (int x = -steps; x <= steps; ++x) {
    for (int y = -steps; y <= steps; ++y) {
      if (x == 0 && y == 0) continue;
      Vector6 twist = Vector6::Zero();
      twist(3) = kTurn * x;
      twist(4) = kTurn * y;
      const SE3 turn = SE3::exp(twist);
      poses.push_back(turn * T_camera_world);
      const Eigen::Vector3d looked_at(0.0, 0.0, depth);
      const SE3 around(turn.rotation(), looked_at - turn.rotation() * looked_at);
      poses.push_back(around * T_camera_world);
    }
  }
  return poses;
}

bool fits(const AlignmentResult& result, const TrackingOptions& options) {
  return result.converged && result.share_good >= static_cast<double>(options.min_share_of_good_points) &&
         isPlausible(result.photometry.brightness);
}

bool isRecognised(const AlignmentResult& result, const TrackingOptions& options) {
  return fits(result, options) && result.share_in_view >= kMinShareInView &&
         result.share_good >= kMinShareGood && result.photometry.brightness.gain < kMaxGain &&
         result.photometry.brightness.gain > 1.0 / kMaxGain;
}

void RecentKeyframes::remember(const TrackedKeyframe& keyframe) {
  keyframes_.push_front({keyframe.pose, keyframe.inverse_depth, compactCopy(keyframe.reference)});
  if (keyframes_.size() > kMaxKeyframes) keyframes_.pop_back();
  next_ = 0;
}

std::optional<OdomPose> RecentKeyframes::find(const ImagePyramid& image, const TrackingOptions& options) {
  for (std::size_t i = 0; i < std::min(kAtATime, keyframes_.size()); ++i) {
    const Known& keyframe = keyframes_[next_++ % keyframes_.size()];
    const std::vector<SE3> starts = turned(SE3(), 1, 1.0 / keyframe.inverse_depth);
    const Photometry photometry{Brightness(), static_cast<double>(options.image_noise)};
    const AlignmentResult result = align({keyframe.reference, image, options, photometry, {}, {}}, starts);
    if (!isRecognised(result, options)) continue;
    return keyframe.pose.then(result.T_frame_keyframe, poseCovariance(result, keyframe.inverse_depth));
  }
  return std::nullopt;
}

}  // namespace rgbd_sfm_fusion
