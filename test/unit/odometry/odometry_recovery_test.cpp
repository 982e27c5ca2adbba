// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// After a loss, a gap, or a change of settings.
#include <cmath>
#include <limits>

#include "visual_odometry_fixture.h"

namespace rgbd_sfm_fusion {
namespace {

TEST_F(VisualOdometryTest, SaysWhenItIsLostAndComesBackToTheSameFrameOfReference) {
  VisualOdometry odometry(scene_.camera(), options_);
  for (int i = 0; i < 5; ++i) odometry.track(frame(i)), odometry.map();
  for (int i = 5; i < 8; ++i) {
    RgbdFrame black = frame(i);
    black.grey.setTo(0);
    black.depth.setTo(std::numeric_limits<double>::quiet_NaN());
    EXPECT_EQ(odometry.track(black).state, TrackingState::kLost);
    EXPECT_FALSE(odometry.map());
  }
  const TrackingResult back = odometry.track(frame(8));
  EXPECT_EQ(back.state, TrackingState::kTracking);
  EXPECT_TRUE(back.relocalised);
  EXPECT_TRUE(odometry.map());
  const SE3 T_first_frame = T_camera_world(0) * T_camera_world(8).inverse();
  EXPECT_LT((back.T_first_frame.inverse() * T_first_frame).log().norm(), 0.01);
}

TEST_F(VisualOdometryTest, FindsItsPlaceThoughTheCameraHasTurnedWhileItSawNothing) {
  for (const double turn : {-0.2, 0.15}) {
    VisualOdometry odometry(scene_.camera(), options_);
    for (int i = 0; i < 5; ++i) odometry.track(frame(i)), odometry.map();
    for (int i = 5; i < 8; ++i) {
      RgbdFrame black = frame(i);
      black.grey.setTo(0);
      EXPECT_EQ(odometry.track(black).state, TrackingState::kLost);
    }
    const SE3 T = motion(0.05, 0.02, 0.0, 0.5 * turn, turn, 0.0) * T_camera_world(5);
    const TrackingResult back = odometry.track(scene_.frame(9 * kPeriod, T, 2.0, 9));
    ASSERT_EQ(back.state, TrackingState::kTracking) << turn;
    EXPECT_TRUE(back.relocalised);
    const SE3 T_first_frame = T_camera_world(0) * T.inverse();
    EXPECT_LT((back.T_first_frame.inverse() * T_first_frame).log().norm(), 0.02) << turn;
  }
}

TEST_F(VisualOdometryTest, FindsAPlaceOfAnEarlierKeyframe) {
  for (const bool feedback : {false, true}) {
    options_.sensor_feedback = feedback;
    VisualOdometry odometry(scene_.camera(), options_);
    const auto at = [](double x) { return motion(-x, 0.0, 0.0, 0.0, 0.0, 0.0); };
    // The camera goes so far that the first keyframe's view is left behind.
    Stamp stamp = kPeriod;
    TrackingResult tracked;
    for (double x = 0.0; x < 1.8; x += 0.03, stamp += kPeriod) {
      tracked = odometry.track(scene_.frame(stamp, at(x), 2.0, 1));
      ASSERT_EQ(tracked.state, TrackingState::kTracking) << x;
      odometry.map();
    }
    const double far = tracked.T_first_frame.translation().x();
    EXPECT_NEAR(far, 1.77, 0.05);
    for (int i = 0; i < 3; ++i, stamp += kPeriod) {
      RgbdFrame black = scene_.frame(stamp, at(0.0));
      black.grey.setTo(0);
      EXPECT_EQ(odometry.track(black).state, TrackingState::kLost);
    }
    const SE3 T = motion(-0.3, 0.03, 0.0, 0.02, 0.05, 0.0);
    // Each frame is compared with some keyframes. After 0.9 s the tracker would start anew.
    TrackingResult back;
    for (int i = 0; i < 15 && back.state != TrackingState::kTracking; ++i, stamp += kPeriod)
      back = odometry.track(scene_.frame(stamp, T, 2.0, 2));
    ASSERT_EQ(back.state, TrackingState::kTracking);
    EXPECT_TRUE(back.relocalised);
    EXPECT_EQ(back.keyframe_stamp, back.stamp);
    EXPECT_LT((back.T_first_frame.inverse() * T.inverse()).log().norm(), 0.03) << feedback;
    EXPECT_TRUE(odometry.map());
    const TrackingResult next = odometry.track(scene_.frame(stamp, at(0.31), 2.0, 3));
    EXPECT_EQ(next.state, TrackingState::kTracking);
    EXPECT_FALSE(next.relocalised);
  }
}

TEST_F(VisualOdometryTest, StartsAnewWhereItDoesNotKnowThePlaceAndSaysSo) {
  VisualOdometry odometry(scene_.camera(), options_);
  for (int i = 0; i < 5; ++i) odometry.track(frame(i)), odometry.map();
  const SE3 T = motion(3.0, 2.0, 0.5, 0.0, 0.0, 1.0);
  TrackingResult tracked;
  int lost = 0;
  for (Stamp stamp = 100 * kPeriod; lost < 30; stamp += kPeriod, ++lost) {
    tracked = odometry.track(scene_.frame(stamp, T));
    if (tracked.state == TrackingState::kTracking) break;
    EXPECT_EQ(tracked.state, TrackingState::kLost);
    EXPECT_FALSE(odometry.map());
  }
  EXPECT_GT(lost, 25) << "it has to be looked for first, as long as a person may be in the way";
  ASSERT_EQ(tracked.state, TrackingState::kTracking);
  EXPECT_EQ(tracked.keyframe_stamp, tracked.stamp);
  EXPECT_TRUE(tracked.relocalised);
  EXPECT_GT(std::sqrt(tracked.pose_covariance.diagonal().minCoeff()), 0.3);
}

TEST_F(VisualOdometryTest, NoPoseContinuesFromAGuess) {
  // A single image in which nothing can be recognised comes right after the last one, or seconds later.
  for (const Stamp gap : {kPeriod, 90 * kPeriod}) {
    VisualOdometry odometry(scene_.camera(), options_);
    for (int i = 0; i < 5; ++i) odometry.track(frame(i)), odometry.map();
    const TrackingResult tracked =
        odometry.track(scene_.frame(5 * kPeriod + gap, motion(3.0, 2.0, 0.5, 0.0, 0.0, 1.0)));
    EXPECT_EQ(tracked.state, TrackingState::kLost) << gap;
  }
}

TEST_F(VisualOdometryTest, FindsItsPlaceAfterAGap) {
  VisualOdometry odometry(scene_.camera(), options_);
  for (int i = 0; i < 5; ++i) odometry.track(frame(i)), odometry.map();
  // The camera has moved on, and has turned to see the same scene.
  const SE3 T = motion(0.35, 0.0, 0.0, 0.0, -0.17, 0.0) * T_camera_world(4);
  const TrackingResult back = odometry.track(scene_.frame(100 * kPeriod, T, 2.0, 9));
  ASSERT_EQ(back.state, TrackingState::kTracking);
  EXPECT_TRUE(back.relocalised);
  const SE3 T_first_frame = T_camera_world(0) * T.inverse();
  EXPECT_LT((back.T_first_frame.inverse() * T_first_frame).log().norm(), 0.02);
}

/// The new keyframe knows nothing of the camera's motion since the last pose.
TEST_F(VisualOdometryTest, OtherPyramidLevelsMakeAFlaggedJump) {
  VisualOdometry odometry(scene_.camera(), options_);
  TrackingResult tracked;
  for (int i = 0; i < 4; ++i) {
    tracked = odometry.track(frame(i));
    odometry.map();
    EXPECT_FALSE(tracked.relocalised) << i;
  }
  const double before = tracked.pose_covariance.diagonal().head<3>().maxCoeff();
  options_.tracking.pyramid_levels = 3;
  odometry.setOptions(options_);
  tracked = odometry.track(frame(4));
  EXPECT_EQ(tracked.state, TrackingState::kTracking);
  EXPECT_EQ(tracked.keyframe_stamp, tracked.stamp);
  EXPECT_TRUE(tracked.relocalised);
  EXPECT_GT(tracked.pose_covariance.diagonal().head<3>().minCoeff(), before + 0.01);
}

TEST_F(VisualOdometryTest, APlaceThatLooksTheSameButIsFartherAwayIsNotRecognised) {
  for (const double farther : {1.0, 1.4}) {
    VisualOdometry odometry(scene_.camera(), options_);
    for (int i = 0; i < 5; ++i) odometry.track(frame(i)), odometry.map();
    RgbdFrame later = scene_.frame(100 * kPeriod, T_camera_world(4), 2.0, 9);
    later.depth *= farther;
    const TrackingState state = odometry.track(later).state;
    EXPECT_EQ(state, farther > 1.0 ? TrackingState::kLost : TrackingState::kTracking) << farther;
  }
}

TEST_F(VisualOdometryTest, TheNextKeyframeWaitsUntilAPersonIsOutOfTheWay) {
  const auto at = [&](int index) { return motion(-0.04 * index, 0.0, 0.0); };
  constexpr int kComes = 8, kGoes = 13;
  options_.keyframe.max_distance = 0.2F;  // so that a keyframe is due meanwhile
  VisualOdometry odometry(scene_.camera(), options_);
  int keyframes_without = 0, keyframes_after = 0;
  for (const bool comes : {false, true}) {
    odometry.reset();
    for (int i = 0; i < 17; ++i) {
      RgbdFrame frame = scene_.frame((i + 1) * kPeriod, at(i), 2.0, static_cast<std::uint64_t>(i) + 1);
      const bool is_there = i >= kComes && i < kGoes;
      if (comes && is_there) {
        const cv::Rect person(200, 0, 100, frame.grey.rows);
        cv::RNG(1).fill(frame.grey(person), cv::RNG::UNIFORM, 0, 255);
        frame.depth(person).setTo(1.0);
      }
      const TrackingResult tracked = odometry.track(frame);
      odometry.map();
      ASSERT_EQ(tracked.state, TrackingState::kTracking) << i;
      const bool is_keyframe = tracked.keyframe_stamp == tracked.stamp;
      if (!comes && is_there) keyframes_without += is_keyframe ? 1 : 0;
      EXPECT_FALSE(comes && is_there && is_keyframe) << i;
      if (comes && i >= kGoes) keyframes_after += is_keyframe ? 1 : 0;
      EXPECT_LT((tracked.T_first_frame.inverse() * at(i).inverse()).log().norm(), 0.03) << i;
    }
  }
  EXPECT_GT(keyframes_without, 0);
  EXPECT_GT(keyframes_after, 0);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
