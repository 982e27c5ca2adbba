// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/frame_tracker.h"

#include "rgbd_sfm_fusion/odometry/hand_over.h"
#include "visual_odometry_fixture.h"

namespace rgbd_sfm_fusion {
namespace {

TEST_F(VisualOdometryTest, WithoutAKeyframeNothingIsTrackedThoughAFrameHasStartedOne) {
  FrameTracker tracker(scene_.camera(), options_);
  HandOver hand_over;
  const auto track = [&](const RgbdFrame& frame) {
    const FrameTracker::Result result = tracker.track(frame, hand_over.keyframeFor(frame.stamp));
    hand_over.addTracked(frame.stamp, result.to_map);
    return result;
  };
  ASSERT_EQ(track(frame(0)).tracked.state, TrackingState::kTracking);
  hand_over.done();  // as if its mapping has thrown

  RgbdFrame black = frame(1);
  black.grey.setTo(0);
  const FrameTracker::Result nowhere = track(black);
  EXPECT_EQ(nowhere.tracked.state, TrackingState::kInitialising);
  EXPECT_FALSE(nowhere.to_map);

  const FrameTracker::Result started = track(frame(2));
  EXPECT_EQ(started.tracked.state, TrackingState::kTracking);
  EXPECT_EQ(started.tracked.keyframe_stamp, frame(2).stamp);
  EXPECT_TRUE(started.tracked.relocalised);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
