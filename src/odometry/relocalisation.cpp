// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/relocalisation.h"

#include <algorithm>

namespace rgbd_sfm_fusion {
namespace {

constexpr std::size_t kMaxKeyframes = 10;  // 1 to 3 MB each
constexpr std::size_t kAtATime = 2;
constexpr double kMinShareInView = 0.5;  // of a keyframe's points, to tell anything of it
// To recognise a keyframe, so much of its points in view has to have the right brightness, and of the squares
// with sensor depth the right depth. One of many starts may end where half of the points fit by chance. Of
// the squares, a wrong place has 0.0 to 0.55, the right one 0.8 to 1.0, less what a person hides.
constexpr double kRecognised = 0.6;
constexpr double kMaxGain = 1.6;  // of brightness, either way: in another light, more points fit by chance
// If less fits, something is in front. Of the points in view, recordings have 0.74 to 0.99, and 0.79 or more
// in nine of ten frames. With a person in front of a tenth of the image it is 0.75, as clothes have more
// points than a room. Half of a keyframe in view, from another side, has as few, but not so of the squares
// with depth.
constexpr double kUnobstructed = 0.8;
constexpr double kUnobstructedByDepth = 0.9;

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
  const auto least = static_cast<double>(options.min_share_of_good_points);
  return result.converged && result.share_good >= least &&
         0.5 * (result.share_good + result.share_of_depth) >= least &&
         isPlausible(result.photometry.brightness);
}

bool isRecognised(const AlignmentResult& result, const TrackingOptions& options) {
  const double gain = result.photometry.brightness.gain;
  return fits(result, options) && gain < kMaxGain && gain > 1.0 / kMaxGain &&
         result.share_in_view >= kMinShareInView &&
         std::min(result.share_good, result.share_of_depth) >= kRecognised;
}

bool isObstructed(const AlignmentResult& result) {
  return result.share_good < kUnobstructed && result.share_of_depth < kUnobstructedByDepth &&
         result.share_in_view >= kMinShareInView;
}

void RecentKeyframes::remember(const Place& keyframe) {
  places_.push_front(std::make_shared<const Place>(Place{keyframe.pose, keyframe.step, keyframe.inverse_depth,
                                                         keyframe.rows_readout_time, keyframe.cells,
                                                         compactCopy(keyframe.reference)}));
  if (places_.size() > kMaxKeyframes) places_.pop_back();
  next_ = 0;
}

std::optional<RecentKeyframes::Found> RecentKeyframes::find(const ImagePyramid& image,
                                                            const TrackingOptions& options,
                                                            const DepthCells& cells, float depth_sigma) {
  for (std::size_t i = 0; i < std::min(kAtATime, places_.size()); ++i) {
    const std::shared_ptr<const Place>& place = places_[next_++ % places_.size()];
    const Photometry photometry{Brightness(), static_cast<double>(options.image_noise)};
    DepthPair depth;
    if (!place->cells.empty() && !cells.empty()) depth = {&place->cells, &cells, 0.0, 0.0, depth_sigma};
    const AlignmentResult result =
        align({place->reference, image, options, photometry, {}, depth}, turned(SE3(), 1, place->depth()));
    if (isRecognised(result, options) && !isObstructed(result)) return Found{place, result};
  }
  return std::nullopt;
}

}  // namespace rgbd_sfm_fusion
