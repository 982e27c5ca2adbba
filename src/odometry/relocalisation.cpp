// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/relocalisation.h"

#include <algorithm>

namespace rgbd_sfm_fusion {
namespace {

constexpr std::size_t kMaxKeyframes = 10;  // 1 MB each
constexpr std::size_t kAtATime = 2;
constexpr double kMinShareInView = 0.5;  // of a keyframe's points, to recognise it
// Of many starts one may end where half of the points fit by chance, in another light more of them.
constexpr double kMinShareGood = 0.6;  // of the points in view
constexpr double kMaxGain = 1.6;       // of brightness, either way

// What a keyframe's depths have wrong in common. Sensors have a scale error of 0.5 % (Khoshelham & Elberink
// 2012); stereo adds as much, or without the sensor drifts by that. Both numbers were chosen on rendered
// seeds 101 to 103: relative poses have a NEES / 6 of about 1 there with the sensor's depth, of 3 to 5
// without. scripts/evaluate prints it as "pose in keyframe".
constexpr double kScaleSigma = 0.0075;
constexpr double kOffsetSigma = 0.004;  // of the mean inverse depth

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

OdomPose OdomPose::then(const SE3& T_other_camera, const Matrix6& relative_covariance) const {
  const Matrix6 Ad = T_other_camera.adjoint();
  return {T_odom_camera * T_other_camera.inverse(), Ad * covariance * Ad.transpose() + relative_covariance};
}

Matrix6 poseCovariance(const AlignmentResult& aligned, double inverse_depth) {
  const Eigen::Vector3d t = aligned.T_frame_keyframe.translation();
  Vector6 by_scale = Vector6::Zero(), by_offset = Vector6::Zero();
  by_scale.head<3>() = kScaleSigma * t;
  // With inverse depths too large by b, pixels move farther by f b (t_x, t_y), as they would by a turn.
  by_offset.tail<3>() = kOffsetSigma * inverse_depth * Eigen::Vector3d(-t.y(), t.x(), 0.0);
  return aligned.covariance + by_scale * by_scale.transpose() + by_offset * by_offset.transpose();
}

void RecentKeyframes::remember(const TrackingReference& keyframe, const OdomPose& pose) {
  keyframes_.push_front({keyframe.pointsOnly(), pose});
  if (keyframes_.size() > kMaxKeyframes) keyframes_.pop_back();
  next_ = 0;
}

std::optional<OdomPose> RecentKeyframes::find(const ImagePyramid& image, double depth,
                                              const TrackingOptions& options) {
  const std::vector<SE3> starts = turned(SE3(), 1, depth);
  for (std::size_t i = 0; i < std::min(kAtATime, keyframes_.size()); ++i) {
    const Keyframe& keyframe = keyframes_[next_++ % keyframes_.size()];
    const AlignmentResult result =
        align(keyframe.reference, image, starts, {Brightness(), static_cast<double>(options.image_noise)},
              FrameShutter(), options);
    if (isRecognised(result, options))
      return keyframe.pose.then(result.T_frame_keyframe, poseCovariance(result, 1.0 / depth));
  }
  return std::nullopt;
}

}  // namespace rgbd_sfm_fusion
