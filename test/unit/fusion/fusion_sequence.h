// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "rgbd_sfm_fusion/fusion/depth_fusion.h"
#include "unit/fusion/depth_images.h"

namespace rgbd_sfm_fusion::test {

constexpr Stamp kFrame = 33'333'333;
constexpr float kSfmSigma = 0.03f;

/// A slanted wall, partly beyond the sensor's range, and a moving camera. SfM sees a third of the wall, in a
/// unit of its own.
class Sequence {
 public:
  explicit Sequence(double alpha) : alpha_(alpha) {
    keyframe_.stamp = 0;
    keyframe_.camera = camera_;
    std::mt19937 random(7);
    std::normal_distribution<float> normal;
    const DepthImage truth = trueDepth(SE3());
    keyframe_.camera = camera_;
    keyframe_.depth = {DepthImage(truth.size(), kNone), cv::Mat_<float>(truth.size(), kNone)};
    for (int y = 0; y < truth.rows; ++y) {
      for (int x = 0; x < truth.cols; ++x) {
        if (std::sin(0.5 * x + 2.0 * std::sin(0.1 * y)) < 0.3) continue;
        const float rho = static_cast<float>(alpha) / truth(y, x);
        const float noisy = rho * (1.0f + kSfmSigma * normal(random));
        keyframe_.depth.mean(y, x) = 1.0f / noisy;
        keyframe_.depth.variance(y, x) = std::pow(kSfmSigma * rho / (noisy * noisy), 2.0f);
      }
    }
  }

  static SE3 pose(int n) {  // T_world_camera [m], with the first camera as world
    Vector6 xi;
    xi << 0.01 * n, -0.004 * n, 0.006 * n, 0.002 * n, 0.004 * n, -0.003 * n;
    return SE3::exp(xi);
  }

  DepthImage trueDepth(const SE3& T_world_camera) const {
    const Eigen::Vector3d n = Eigen::Vector3d(-0.8, 0.1, 1.0).normalized();
    const Eigen::Vector3d there = T_world_camera.rotation().conjugate() * n;
    return plane(camera_, there, 3.0 - n.dot(T_world_camera.translation()));
  }

  TrackingResult tracked(int n) const {
    TrackingResult frame;
    frame.stamp = n * kFrame;
    frame.state = TrackingState::kTracking;
    frame.keyframe_stamp = keyframe_.stamp;
    const SE3 T_frame_keyframe = pose(n).inverse();
    frame.T_frame_keyframe = {T_frame_keyframe.rotation(), T_frame_keyframe.translation() / alpha_};
    frame.T_first_frame = frame.T_frame_keyframe.inverse();
    return frame;
  }

  RgbdFrame frame(int n) const {
    RgbdFrame frame;
    frame.stamp = frame.depth_stamp = n * kFrame;
    frame.depth = trueDepth(pose(n));
    std::mt19937 random(static_cast<unsigned>(n));
    std::normal_distribution<float> normal;
    const DepthNoiseModel noise;
    for (float& depth : frame.depth) {
      depth += noise.sigmaZ(depth) * normal(random);
      if (depth > noise.max_range) depth = kNone;
    }
    return frame;
  }

  FusedFrame fuse(DepthFusion& fusion, int n) const { return fusion.fuse(tracked(n), keyframe(), frame(n)); }

  std::shared_ptr<const KeyframeMap> keyframe() const { return std::make_shared<KeyframeMap>(keyframe_); }
  const PinholeCamera& camera() const { return camera_; }

 private:
  double alpha_;
  PinholeCamera camera_ = smallCamera();
  KeyframeMap keyframe_;
};

inline ScaleOptions forSmallImages() {
  ScaleOptions options;
  options.min_pixels = 100;
  return options;
}

inline FusionOptions options() {
  FusionOptions result;
  result.scale = forSmallImages();
  return result;
}

inline void expectConsistent(const FusedFrame& fused) {
  EXPECT_TRUE(isConsistent(fused.depth));
  ProvenanceCounts counts;
  for (int y = 0; y < fused.depth.mean.rows; ++y) {
    for (int x = 0; x < fused.depth.mean.cols; ++x) {
      const int source = fused.provenance(y, x);
      ASSERT_LE(source, 3);
      ASSERT_EQ(source == 0, std::isnan(fused.depth.mean(y, x)));
      ASSERT_FALSE(std::sqrt(fused.depth.variance(y, x)) > 0.2f * fused.depth.mean(y, x));
      counts += ProvenanceCounts{source == 1 ? 1u : 0u, source == 2 ? 1u : 0u, source == 3 ? 1u : 0u};
    }
  }
  EXPECT_EQ(counts.sensor_only, fused.counts.sensor_only);
  EXPECT_EQ(counts.sfm_only, fused.counts.sfm_only);
  EXPECT_EQ(counts.fused, fused.counts.fused);
}

}  // namespace rgbd_sfm_fusion::test
