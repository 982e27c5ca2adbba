// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Which map a frame is tracked against, with mapping in turn, beside tracking, and too slow.
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "rgbd_sfm_fusion/odometry/keyframe.h"
#include "visual_odometry_fixture.h"

namespace rgbd_sfm_fusion {
namespace {

TEST_F(VisualOdometryTest, FramesAreTrackedAgainstTheMapOfTwoFramesBefore) {
  options_.keyframe.max_distance = 0.03F;
  for (const auto& [period, usual_lag] : {std::pair<Stamp, std::uint32_t>(kPeriod, 2), {6 * kPeriod, 1}}) {
    VisualOdometry odometry(scene_.camera(), options_);
    int keyframes = 0;
    std::uint32_t after_keyframe = 0;
    for (int i = 0; i < 36; ++i) {
      const std::uint32_t lag = i <= static_cast<int>(kEnoughViews) ? 1 : usual_lag;
      RgbdFrame given = frame(i);
      given.stamp = given.depth_stamp = (i + 1) * period;
      const TrackingResult tracked = odometry.track(given);
      ASSERT_TRUE(odometry.map());
      after_keyframe = tracked.keyframe_stamp == tracked.stamp ? 0 : after_keyframe + 1;
      keyframes += after_keyframe == 0 ? 1 : 0;
      // The frame after a keyframe is tracked against it, too, though it has no stereo of its own yet.
      EXPECT_EQ(tracked.keyframe_revision, after_keyframe < lag ? 0 : after_keyframe - lag) << i;
    }
    EXPECT_GE(keyframes, 3);
  }
}

/// Tracks and maps in two threads.
std::vector<SE3> trackedBeside(VisualOdometry& odometry, const std::vector<RgbdFrame>& frames) {
  std::atomic<bool> has_ended{false};
  std::thread mapping([&] {
    while (!has_ended) {
      if (!odometry.map()) std::this_thread::yield();
    }
  });
  std::vector<SE3> poses;
  for (const RgbdFrame& frame : frames) {
    odometry.waitForMap(frame.stamp);
    poses.push_back(odometry.track(frame).T_first_frame);
  }
  odometry.waitForAllMaps();
  has_ended = true;
  mapping.join();
  return poses;
}

TEST_F(VisualOdometryTest, MappingInAThreadOfItsOwnGivesTheSamePoses) {
  options_.keyframe.max_distance = 0.03F;
  VisualOdometry alone(scene_.camera(), options_), beside(scene_.camera(), options_);
  std::vector<RgbdFrame> frames;
  for (int i = 0; i < 30; ++i) frames.push_back(frame(i));
  const std::vector<SE3> poses = trackedBeside(beside, frames);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const TrackingResult tracked = alone.track(frames[i]);
    alone.map();
    EXPECT_EQ(tracked.T_first_frame.translation(), poses[i].translation()) << i;
    EXPECT_EQ(tracked.T_first_frame.rotation().coeffs(), poses[i].rotation().coeffs()) << i;
  }
}

TEST_F(VisualOdometryTest, UnderLoadFramesAreTrackedThoughTheyAreNotMapped) {
  options_.keyframe.max_distance = 0.03F;
  VisualOdometry odometry(scene_.camera(), options_);
  int keyframes = 0;
  std::size_t skipped = 0;
  for (int i = 0; i < 24; ++i) {
    EXPECT_TRUE(odometry.waitForMap(frame(i).stamp, 0.0)) << i;
    const TrackingResult tracked = odometry.track(frame(i));
    ASSERT_EQ(tracked.state, TrackingState::kTracking) << i;
    const SE3 T_first_frame = T_camera_world(0) * T_camera_world(i).inverse();
    EXPECT_LT((tracked.T_first_frame.inverse() * T_first_frame).log().norm(), 0.01) << i;
    // Mapping keeps up with keyframes only.
    skipped += odometry.skipMaps();
    const bool is_keyframe = tracked.keyframe_stamp == tracked.stamp;
    keyframes += is_keyframe ? 1 : 0;
    EXPECT_EQ(static_cast<bool>(odometry.map()), is_keyframe) << i;
  }
  EXPECT_GE(keyframes, 3);
  EXPECT_EQ(skipped, static_cast<std::size_t>(24 - keyframes));
}

TEST_F(VisualOdometryTest, AKeyframeIsNotLeftOut) {
  VisualOdometry odometry(scene_.camera(), options_);
  odometry.track(frame(0));
  EXPECT_EQ(odometry.skipMaps(), 0U);
  EXPECT_FALSE(odometry.waitForMap(frame(1).stamp, 0.0));
  EXPECT_THROW(odometry.track(frame(1)), std::logic_error);
  EXPECT_TRUE(odometry.map());
  EXPECT_TRUE(odometry.waitForMap(frame(1).stamp, 0.0));
  EXPECT_EQ(odometry.track(frame(1)).state, TrackingState::kTracking);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
