// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// The fusion stage against OpenCV's rgbd::registerDepth, which only reprojects, on one core.
///
///     fusion_benchmark                              a synthetic frame of 640x480, again and again
///     fusion_benchmark SEQUENCE_DIR [--frames N]    the frames of a recording, both in turn on each
///
/// Completion is part of the stage; --no-completion leaves it out.
///
/// The synthetic keyframe is semi-dense as on real images: depth along bands of a few pixels, on a third of
/// them. SEQUENCE_DIR is in the TUM RGB-D layout. Its images are read, rectified, tracked and mapped outside
/// the clock.
#include <benchmark/benchmark.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/rgbd.hpp>
#include <random>
#include <string>
#include <vector>

#include "rgbd_sfm_fusion/fusion/depth_fusion.h"
#include "rgbd_sfm_fusion/pipeline/pipeline.h"
#include "rgbd_sfm_fusion/tools/tum_sequence.h"

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
  input.tracked.T_odom_frame = input.tracked.T_frame_keyframe.inverse();
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
    input.tracked.T_odom_frame = input.tracked.T_odom_frame * input.step;
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

// --- A recording ------------------------------------------------------------------------------------------

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0.0 : values[values.size() / 2];
}

/// [ms] that a call takes.
template <class Call>
double timeOf(const Call& call) {
  const auto start = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

CameraCalibration calibrationOf(const TumSequence& sequence) {
  CameraCalibration calibration;
  calibration.width = sequence.width;
  calibration.height = sequence.height;
  calibration.K = {sequence.fx, 0.0, sequence.cx, 0.0, sequence.fy, sequence.cy, 0.0, 0.0, 1.0};
  calibration.distortion_model = "plumb_bob";
  calibration.D.assign(sequence.distortion.begin(), sequence.distortion.end());
  return calibration;
}

RawImage depthImage(const TumSequence& sequence, const TumSequence::Pair& pair) {
  cv::Mat metres;
  const cv::Mat codes = cv::imread(pair.depth_path, cv::IMREAD_UNCHANGED);
  codes.convertTo(metres, CV_32F, 1.0 / sequence.depth_scale);
  metres.setTo(std::numeric_limits<double>::quiet_NaN(), codes == 0);
  return {pair.depth_stamp, "32FC1", metres};
}

void fuseRecording(const std::string& folder, std::size_t frames, const FusionOptions& options) {
  const TumSequence sequence = readTumSequence(folder);
  Pipeline pipeline(calibrationOf(sequence), OdometryOptions(), options);
  std::vector<double> fused, peer;
  for (std::size_t i = 0; i < std::min(frames, sequence.pairs.size()); ++i) {
    const TumSequence::Pair& pair = sequence.pairs[i];
    MappedFrame mapped =
        pipeline.map({pair.rgb_stamp, "mono8", cv::imread(pair.rgb_path, cv::IMREAD_GRAYSCALE)},
                     depthImage(sequence, pair));
    const SE3 T_frame_keyframe = mapped.tracked.T_frame_keyframe;
    const DepthImage depth = mapped.frame.depth;
    const bool tracking = mapped.tracked.state == TrackingState::kTracking;
    const double milliseconds = pipeline.fuse(std::move(mapped)).fusion_ms;
    if (!tracking) continue;
    fused.push_back(milliseconds);
    peer.push_back(timeOf(
        [&] { benchmark::DoNotOptimize(registered(pipeline.camera(), T_frame_keyframe, depth).data); }));
  }
  std::printf("%zu frames: fusion stage %.2f ms, registerDepth %.2f ms (medians); ratio %.3f\n", fused.size(),
              median(fused), median(peer), median(fused) / median(peer));
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  benchmark::Initialize(&argc, argv);
  CLI::App app("Time of the fusion stage beside OpenCV's registerDepth");
  std::string sequence;
  std::size_t frames = 1000000;
  app.add_option("SEQUENCE_DIR", sequence,
                 "a recording in the TUM RGB-D layout (default: a synthetic frame)");
  app.add_option("--frames", frames, "of the recording");
  FusionOptions options;
  app.add_flag("!--no-completion", options.complete, "do not fill holes between measured depths");
  CLI11_PARSE(app, argc, argv);
  if (sequence.empty()) {
    benchmark::RunSpecifiedBenchmarks();
  } else {
    fuseRecording(sequence, frames, options);
  }
  return 0;
}
