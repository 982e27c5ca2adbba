// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "rgbd_sfm_fusion/odometry/visual_odometry.h"
#include "synthetic_views.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kInterval = 1.0 / 30.0;  // [s]
constexpr int kFrames = 30;

/// A camera in a hand that shakes, up to 5 px from frame to frame.
SE3 T_camera_world(double time) {
  return motion(0.12 * std::sin(6.0 * time), 0.08 * std::sin(5.0 * time + 1.0), 0.03 * std::sin(4.0 * time),
                0.0, 0.04 * std::sin(7.0 * time), 0.03 * std::sin(5.5 * time));
}

/// The tracked poses of the sequence.
/// @param maps         the maps that are published after each frame
/// @param depth_until  number of the first frame whose depth image has no depth
/// @param late         number of a frame that arrived late, right before the next one, and has that stamp
std::vector<TrackingResult> track(double shutter, const OdometryOptions& options,
                                  std::vector<std::shared_ptr<const KeyframeMap>>* maps = nullptr,
                                  int depth_until = kFrames, int late = -1) {
  const PlaneScene scene(smallCamera());
  VisualOdometry odometry(scene.camera(), options);
  std::vector<TrackingResult> results;
  for (int i = 0; i < kFrames; ++i) {
    const double time = i * kInterval;
    const ReadoutMotion readout{
        (T_camera_world(time + 0.5 * shutter) * T_camera_world(time - 0.5 * shutter).inverse()).log()};
    RgbdFrame frame = scene.frame(fromSeconds(1.0 + time), T_camera_world(time), 2.0,
                                  static_cast<std::uint64_t>(i) + 1, readout);
    if (i >= depth_until) frame.depth = DepthImage(frame.depth.size(), 0.0F);
    if (i == late) frame.stamp = frame.depth_stamp = fromSeconds(1.0 + time + 0.94 * kInterval);
    results.push_back(odometry.track(frame));
    const auto map = odometry.map();
    if (maps != nullptr) maps->push_back(map);
  }
  return results;
}

/// Root mean square error of the position from frame to frame, once the shutter may be known.
double stepError(const std::vector<TrackingResult>& results) {
  double sum = 0.0;
  int count = 0;
  for (int i = 13; i < kFrames; ++i, ++count) {
    const auto &now = results[static_cast<std::size_t>(i)],
               &before = results[static_cast<std::size_t>(i) - 1];
    const SE3 T_now_before = now.T_first_frame.inverse() * before.T_first_frame;
    const SE3 truth = T_camera_world(i * kInterval) * T_camera_world((i - 1) * kInterval).inverse();
    sum += (T_now_before * truth.inverse()).log().squaredNorm();
  }
  return std::sqrt(sum / count);
}

OdometryOptions options(bool estimate, float readout_time) {
  OdometryOptions options;
  options.tracking.pyramid_levels = 4;
  options.estimate_readout = estimate;
  options.readout_time = readout_time;
  return options;
}

// In the image of a camera that hangs upside down, turned upright, the last row was read first.
constexpr float kReadoutTimes[] = {0.025F, -0.025F};

TEST(RollingShutter, PosesGainFromAKnownReadoutTime) {
  for (const float shutter : kReadoutTimes) {
    const double ignored = stepError(track(static_cast<double>(shutter), options(false, 0.0F)));
    const double known = stepError(track(static_cast<double>(shutter), options(false, shutter)));
    EXPECT_LT(known, 0.5 * ignored) << known << " of " << ignored << ", " << shutter << " s";
  }
}

TEST(RollingShutter, ReadoutTimeIsLearned) {
  for (const float shutter : kReadoutTimes) {
    const double ignored = stepError(track(static_cast<double>(shutter), options(false, 0.0F)));
    const double learned = stepError(track(static_cast<double>(shutter), options(true, 0.0F)));
    EXPECT_LT(learned, 0.6 * ignored) << learned << " of " << ignored << ", " << shutter << " s";
  }
}

/// Stamps of arrival: the frame after one that was late seems to come 2 ms later.
TEST(RollingShutter, WhatWasLearnedOutlastsAFrameThatArrivesLate) {
  for (const float shutter : kReadoutTimes) {
    const auto learned = track(static_cast<double>(shutter), options(true, 0.0F), nullptr, kFrames, 22);
    for (std::size_t i = 20; i < learned.size(); ++i)
      EXPECT_NEAR(learned[i].readout_time, static_cast<double>(shutter), 0.005) << i;
  }
}

TEST(RollingShutter, NothingIsLearnedFromAGlobalShutter) {
  const auto fixed = track(0.0, options(false, 0.0F)), learned = track(0.0, options(true, 0.0F));
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    EXPECT_EQ(fixed[i].T_frame_keyframe.log(), learned[i].T_frame_keyframe.log()) << i;
  }
}

TEST(RollingShutter, AGlobalShutterIsKnownExactly) {
  OdometryOptions not_learning = options(false, 0.0F), learning = options(true, 0.0F);
  not_learning.estimate_principal_point = learning.estimate_principal_point = false;
  const TrackingResult fixed = track(0.0, not_learning).back();
  const std::vector<TrackingResult> learned = track(0.0, learning);
  EXPECT_GT(learned.front().readout_sigma, 0.010) << "of 0, or 10 to 33 ms either way";
  EXPECT_LT(learned.back().readout_sigma, 1e-5);
  EXPECT_GT(learned.back().readout_sigma, 0.0) << "0: it is set";
  EXPECT_NEAR((learned.back().covariance - fixed.covariance).norm() / fixed.covariance.norm(), 0.0, 1e-3);
}

TEST(RollingShutter, ALearnedReadoutTimeKeepsAnHonestSigma) {
  for (const double shutter : {0.012, 0.025, -0.012, -0.025}) {
    const TrackingResult learned = track(shutter, options(true, 0.0F)).back();
    EXPECT_LT(std::abs(learned.readout_time - shutter), 3.0 * learned.readout_sigma) << shutter;
    EXPECT_GT(learned.readout_sigma, 1e-4) << shutter;
    EXPECT_LT(learned.readout_sigma, 0.005) << shutter;
  }
}

TEST(RollingShutter, StereoGoesOnAsItBecomesKnown) {
  std::vector<std::shared_ptr<const KeyframeMap>> maps;
  track(0.025, options(true, 0.0F), &maps);
  for (std::size_t i = 5; i < maps.size(); ++i)
    EXPECT_GT(cv::countNonZero(maps[i]->depth.mean > 0.0F), 0) << i;
}

/// Without sensor depth, tracking rests on what stereo has found until then.
TEST(RollingShutter, ThatBecomesKnownWithoutSensorDepthLosesNoFrame) {
  for (int until = 8; until < 14; ++until) {
    for (const TrackingResult& result : track(0.025, options(true, 0.0F), nullptr, until))
      EXPECT_EQ(result.state, TrackingState::kTracking) << until << ", " << toSeconds(result.stamp);
  }
}

TEST(RollingShutter, WhileItIsUnknownThereIsDepthWithAnHonestVariance) {
  for (const double shutter : {0.0, 0.015, 0.03, -0.03}) {
    const PlaneScene scene(smallCamera());
    std::vector<std::shared_ptr<const KeyframeMap>> maps;
    track(shutter, options(true, 0.0F), &maps);
    double sum = 0.0;
    int count = 0;
    for (std::size_t i = 3; i < 7; ++i) {
      const KeyframeMap& map = *maps[i];
      const double time = toSeconds(map.stamp) - 1.0;
      const ReadoutMotion readout{
          (T_camera_world(time + 0.5 * shutter) * T_camera_world(time - 0.5 * shutter).inverse()).log()};
      const DepthImage truth = scene.depthImage(T_camera_world(time), readout);
      for (int v = 0; v < truth.rows; ++v) {
        for (int u = 0; u < truth.cols; ++u) {
          if (!(map.depth.mean(v, u) > 0.0F)) continue;
          const auto error = static_cast<double>(map.depth.mean(v, u) - truth(v, u));
          sum += std::min(error * error / static_cast<double>(map.depth.variance(v, u)), 25.0);
          ++count;
        }
      }
    }
    EXPECT_GT(count, 2000) << shutter;
    EXPECT_LT(sum / count, 2.0) << shutter;
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
