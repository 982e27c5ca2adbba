// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/earlier_keyframes.h"

#include <algorithm>

#include "rgbd_sfm_fusion/odometry/alignment_verdict.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::size_t kMaxKeyframes = 10;  // 1 to 3 MB each
constexpr std::size_t kAtATime = 2;

}  // namespace

std::vector<SE3> turned(const SE3& T_camera_keyframe, int steps, double depth) {
  constexpr double kTurn = 0.1;  // [rad] coarse levels find the rest
  std::vector<SE3> poses{T_camera_keyframe};
  for (int x = -steps; x <= steps; ++x) {
    for (int y = -steps; y <= steps; ++y) {
      if (x == 0 && y == 0) continue;
      Vector6 twist = Vector6::Zero();
      twist(3) = kTurn * x;
      twist(4) = kTurn * y;
      const SE3 turn = SE3::exp(twist);
      poses.push_back(turn * T_camera_keyframe);
      const Eigen::Vector3d looked_at(0.0, 0.0, depth);
      const SE3 around(turn.rotation(), looked_at - turn.rotation() * looked_at);
      poses.push_back(around * T_camera_keyframe);
    }
  }
  return poses;
}

void EarlierKeyframes::remember(const Place& keyframe) {
  places_.push_front(std::make_shared<const Place>(
      Place{keyframe.pose, keyframe.step, keyframe.mean_inverse_depth, keyframe.reference_readout_time,
            keyframe.cells, compactCopy(keyframe.reference)}));
  if (places_.size() > kMaxKeyframes) places_.pop_back();
  next_ = 0;
}

std::optional<EarlierKeyframes::Found> EarlierKeyframes::find(const ImagePyramid& image,
                                                              const TrackingOptions& options,
                                                              const DepthCells& cells, float depth_sigma) {
  for (std::size_t i = 0; i < std::min(kAtATime, places_.size()); ++i) {
    const std::shared_ptr<const Place>& place = places_[next_++ % places_.size()];
    const Photometry photometry{Brightness(), static_cast<double>(options.image_noise)};
    DepthPair depth;
    if (!place->cells.empty() && !cells.empty()) depth = {&place->cells, &cells, 0.0, 0.0, depth_sigma};
    const AlignmentResult result = alignFromFar({place->reference, image, options, photometry, {}, depth},
                                                turned(SE3(), 1, place->sceneDepth()));
    if (isRecognised(result, options) && !isObstructed(result)) return Found{place, result};
  }
  return std::nullopt;
}

}  // namespace rgbd_sfm_fusion
