// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// The fusion stage, completion included, against OpenCV's rgbd::registerDepth, which only reprojects, on one
/// core: a synthetic frame of 640x480, again and again. recording_benchmark does it on recordings.
///
/// The keyframe is semi-dense as on real images: depth along bands of a few pixels, on a third of them.
#include <benchmark/benchmark.h>

#include <cmath>
#include <limits>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <opencv2/rgbd.hpp>
#include <random>

#include "rgbd_sfm_fusion/fusion/depth_fusion.h"

namespace {

using namespace rgbd_sfm_fusion;

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr Stamp kStep = 33'333'333;  // [ns]

struct Input {
  PinholeCamera camera{640, 480, 525.0, 525.0, 319.5, 239.5};
  KeyframeMap keyframe;
  TrackingResult tracked;
  RgbdFrame frame;
  SE3 step;  ///< motion between two frames
};

/// A wall with a nearer box in front of it, and a sensor with holes.
Input makeInput() {
  Input input;
  const cv::Size size(input.camera.width, input.camera.height);
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  cv::Mat_<float> texture(size);
  for (float& value : texture) value = normal(random);
  cv::GaussianBlur(texture, texture, {0, 0}, 6.0);
  input.keyframe.camera = input.camera;
  input.keyframe.stamp = 0;
  input.keyframe.depth = {DepthImage(size, kNone), cv::Mat_<float>(size, kNone)};
  input.frame.depth = DepthImage(size, kNone);
  input.frame.grey = GreyImage(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const bool box = x > 200 && x < 400 && y > 150 && y < 350;
      const float truth = box ? 1.2f : 2.0f + 0.002f * static_cast<float>(x);
      if (std::abs(texture(y, x)) < 0.02f) {
        const float rho = (1.0f + 0.03f * normal(random)) / truth;
        input.keyframe.depth.mean(y, x) = 1.0f / rho;
        input.keyframe.depth.variance(y, x) = std::pow(0.03f / truth / (rho * rho), 2.0f);
      }
      input.frame.grey(y, x) = cv::saturate_cast<std::uint8_t>(128.0f + 500.0f * texture(y, x));
      if (texture(y, x) < 0.06f)
        input.frame.depth(y, x) = truth + DepthNoiseModel().sigmaZ(truth) * normal(random);
    }
  }
  Vector6 motion;
  motion << 0.02, 0.01, -0.03, 0.004, -0.006, 0.003;
  input.tracked.state = TrackingState::kTracking;
  input.tracked.keyframe_stamp = input.keyframe.stamp;
  input.tracked.T_frame_keyframe = SE3::exp(motion);
  input.tracked.T_first_frame = input.tracked.T_frame_keyframe.inverse();
  input.step = SE3::exp(0.3 * motion);
  input.tracked.covariance = 1e-6 * Matrix6::Identity();
  return input;
}

/// As OpenCV does it, into fresh images in every call.
cv::Mat registered(const PinholeCamera& camera, const SE3& T_target_source, const DepthImage& depth) {
  const cv::Matx33d K(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const Eigen::Matrix3d R = T_target_source.rotationMatrix();
  const Eigen::Vector3d t = T_target_source.translation();
  const cv::Matx44d Rt(R(0, 0), R(0, 1), R(0, 2), t(0), R(1, 0), R(1, 1), R(1, 2), t(1), R(2, 0), R(2, 1),
                       R(2, 2), t(2), 0, 0, 0, 1);
  cv::Mat result;
  cv::rgbd::registerDepth(K, K, cv::noArray(), Rt, depth, {camera.width, camera.height}, result);
  return result;
}

/// The first to run: what its fresh images cost depends on who has used the heap before.
void registerDepth(benchmark::State& state) {
  const Input input = makeInput();
  for (auto _ : state)
    benchmark::DoNotOptimize(
        registered(input.camera, input.tracked.T_frame_keyframe, input.frame.depth).data);
}
BENCHMARK(registerDepth)->Unit(benchmark::kMillisecond);

void fuseFrames(benchmark::State& state, Stamp skew) {
  Input input = makeInput();
  DepthFusion fusion(input.camera, FusionOptions());
  const auto keyframe = std::make_shared<const KeyframeMap>(input.keyframe);
  Stamp stamp = 0;
  for (auto _ : state) {
    stamp += kStep;
    input.tracked.T_first_frame = input.tracked.T_first_frame * input.step;
    input.frame.stamp = input.tracked.stamp = stamp;
    input.frame.depth_stamp = stamp - skew;
    benchmark::DoNotOptimize(fusion.fuse(input.tracked, keyframe, input.frame));
  }
}

void fusionStage(benchmark::State& state) {
  fuseFrames(state, 0);
}
BENCHMARK(fusionStage)->Unit(benchmark::kMillisecond);

/// With the depth image 10 ms before the colour image, as on TUM freiburg1.
void fusionStageWithSkew(benchmark::State& state) {
  fuseFrames(state, 10'000'000);
}
BENCHMARK(fusionStageWithSkew)->Unit(benchmark::kMillisecond);

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
