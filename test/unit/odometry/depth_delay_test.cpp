// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// A hand-held camera whose depth images are older than their stamps say.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "rgbd_sfm_fusion/odometry/self_calibration.h"
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"
#include "synthetic_views.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kInterval = 1.0 / 30.0;  // [s]
constexpr int kFrames = 120;

/// A hand that sways to and fro.
SE3 T_camera_world(double time) {
  return motion(0.12 * std::sin(3.7 * time), 0.1 * std::sin(4.3 * time), 0.1 * std::sin(2.9 * time),
                0.1 * std::sin(4.9 * time), 0.12 * std::sin(3.1 * time), 0.08 * std::sin(3.9 * time));
}

struct Sensor {
  double delay = 0.0;  // [s] by which depth is older than its stamp says
  double skew = 0.0;   // [s] by which its stamp is before that of colour
  bool misses_frames = false;
};

OdometryOptions optionsOf(bool estimate) {
  OdometryOptions options;
  options.tracking.pyramid_levels = 4;
  options.estimate_readout = options.estimate_principal_point = false;
  options.estimate_depth_delay = estimate;
  options.keyframe.max_distance = 0.05F;  // one keyframe alone makes nothing clear
  return options;
}

/// The colour images are the same for all sensors.
const RgbdFrame& colour(const PlaneScene& scene, int i) {
  static std::vector<RgbdFrame> frames;
  for (int n = static_cast<int>(frames.size()); n <= i; ++n) {
    const double time = n * kInterval;
    frames.push_back(
        scene.frame(fromSeconds(1.0 + time), T_camera_world(time), 2.0, static_cast<std::uint64_t>(n) + 1));
  }
  return frames[static_cast<std::size_t>(i)];
}

std::vector<TrackingResult> track(const Sensor& sensor, const OdometryOptions& options) {
  const PlaneScene scene(smallCamera());
  VisualOdometry odometry(scene.camera(), options);
  std::vector<TrackingResult> results;
  for (int i = 0; i < kFrames; ++i) {
    if (sensor.misses_frames && i % 7 == 3) continue;
    const double time = i * kInterval;
    RgbdFrame frame = colour(scene, i);
    frame.depth_stamp = frame.stamp - fromSeconds(sensor.skew);
    frame.depth = scene.depthImage(T_camera_world(time - sensor.skew - sensor.delay));
    results.push_back(odometry.track(frame));
    odometry.map();
  }
  return results;
}

/// Root mean square error of the motion from frame to frame, in the last two seconds.
double stepError(const std::vector<TrackingResult>& results) {
  double sum = 0.0;
  for (int i = kFrames - 60; i < kFrames; ++i) {
    const auto &now = results[static_cast<std::size_t>(i)],
               &before = results[static_cast<std::size_t>(i) - 1];
    const SE3 T_now_before = now.T_first_frame.inverse() * before.T_first_frame;
    const SE3 truth = T_camera_world(i * kInterval) * T_camera_world((i - 1) * kInterval).inverse();
    sum += (T_now_before * truth.inverse()).log().squaredNorm();
  }
  return std::sqrt(sum / 60.0);
}

TEST(DepthDelay, IsFoundEitherWay) {
  for (const double delay : {0.02, -0.02}) {
    const std::vector<TrackingResult> learned = track({delay}, optionsOf(true));
    const TrackingResult& last = learned.back();
    EXPECT_NEAR(last.depth_delay, delay, 0.006) << last.depth_delay_sigma;
    EXPECT_LT(last.depth_delay_sigma, 0.004);
    EXPECT_NE(remarkOnDepthDelay(last), "");
    EXPECT_LT(stepError(learned), 0.95 * stepError(track({delay}, optionsOf(false))));
  }
}

TEST(DepthDelay, IsFoundBesideAStampedSkewAndWithMissingFrames) {
  for (const Sensor& sensor : {Sensor{0.02, 0.012}, Sensor{0.02, -0.012, true}}) {
    const TrackingResult last = track(sensor, optionsOf(true)).back();
    EXPECT_NEAR(last.depth_delay, sensor.delay, 0.008) << sensor.skew;
  }
}

TEST(DepthDelay, IsNotLearnedWhereDepthIsNotMoved) {
  OdometryOptions options = optionsOf(true);
  options.compensate_skew = false;
  const TrackingResult last = track({0.02}, options).back();
  EXPECT_EQ(last.depth_delay, 0.0);
  EXPECT_EQ(last.depth_delay_sigma, 0.0);
}

TEST(DepthDelay, OfRightStampsIsZero) {
  const std::vector<TrackingResult> fixed = track({}, optionsOf(false)), learned = track({}, optionsOf(true));
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    EXPECT_EQ(learned[i].depth_delay, 0.0) << i;
    EXPECT_EQ(fixed[i].T_frame_keyframe.log(), learned[i].T_frame_keyframe.log()) << i;
  }
  EXPECT_GT(learned.front().depth_delay_sigma, 0.008) << "the camera did not move yet";
  EXPECT_LT(learned.back().depth_delay_sigma, 0.002);
  EXPECT_EQ(remarkOnDepthDelay(learned.back()), "");
  EXPECT_EQ(fixed.back().depth_delay_sigma, 0.0) << "nothing is learned";
  EXPECT_EQ(track({0.0, 0.012}, optionsOf(true)).back().depth_delay, 0.0) << "as stamped";
}

}  // namespace
}  // namespace rgbd_sfm_fusion
