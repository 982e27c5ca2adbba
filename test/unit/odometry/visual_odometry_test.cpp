// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Poses, and what may be given.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>

#include "visual_odometry_fixture.h"

namespace rgbd_sfm_fusion {
namespace {

TEST_F(VisualOdometryTest, TrackingEndsOnTheLevelThatIsSet) {
  const auto poseAfter = [&](int finest_level) {
    options_.tracking.finest_level = finest_level;
    VisualOdometry odometry(scene_.camera(), options_);
    TrackingResult tracked;
    for (int i = 0; i < 8; ++i) {
      tracked = odometry.track(frame(i));
      odometry.map();
    }
    return tracked.T_first_frame;
  };
  const SE3 full = poseAfter(0), half = poseAfter(1);
  EXPECT_NE(half.translation(), full.translation());
  EXPECT_LT((full.inverse() * half).log().norm(), 0.01);
}

TEST_F(VisualOdometryTest, ABorderOfOneBrightnessDoesNotMatter) {
  options_.keyframe.max_distance = 0.03F;  // so that there are several keyframes
  const cv::Rect inside(6, 5, scene_.camera().width - 13, scene_.camera().height - 11);
  const auto poseAfter = [&](std::uint8_t border) {
    VisualOdometry odometry(scene_.camera(), options_);
    TrackingResult tracked;
    for (int i = 0; i < 20; ++i) {
      RgbdFrame given = frame(i);
      GreyImage grey(given.grey.size(), border);
      given.grey(inside).copyTo(grey(inside));
      given.grey = grey;
      tracked = odometry.track(given);
      odometry.map();
      EXPECT_EQ(tracked.state, TrackingState::kTracking) << i;
    }
    return tracked.T_first_frame;
  };
  EXPECT_EQ((poseAfter(0).inverse() * poseAfter(255)).log().norm(), 0.0);
}

TEST_F(VisualOdometryTest, WhatTheCameraHasNotSeenDoesNotMatter) {
  options_.keyframe.max_distance = 0.03F;  // so that there are several keyframes
  const PinholeCamera& camera = scene_.camera();
  const cv::Rect seen(24, 16, camera.width - 48, camera.height - 36);
  const auto run = [&](std::uint64_t seed) {
    // Around the part that the camera has seen, a pattern stays where it is while the camera moves.
    GreyImage rim(camera.height, camera.width);
    cv::RNG(seed).fill(rim, cv::RNG::UNIFORM, 0, 256);
    VisualOdometry odometry(camera, options_);
    std::shared_ptr<const KeyframeMap> map;
    TrackingResult tracked;
    for (int i = 0; i < 40; ++i) {
      RgbdFrame given = frame(i);
      given.seen = seen;
      GreyImage grey = rim.clone();
      given.grey(seen).copyTo(grey(seen));
      given.grey = grey;
      tracked = odometry.track(given);
      map = odometry.map();
      EXPECT_EQ(tracked.state, TrackingState::kTracking) << i;
    }
    EXPECT_GT(map->stamp, frame(0).stamp);
    return std::make_pair(tracked.T_first_frame, map->depth);
  };
  const auto [pose, depth] = run(1);
  const auto [other_pose, other_depth] = run(2);
  EXPECT_EQ((pose.inverse() * other_pose).log().norm(), 0.0);
  EXPECT_EQ(cv::countNonZero(depth.mean > 0.0), cv::countNonZero(other_depth.mean > 0.0));
  EXPECT_GT(cv::countNonZero(depth.mean(seen) > 0.0), 1000);
  EXPECT_EQ(cv::countNonZero(depth.mean > 0.0), cv::countNonZero(depth.mean(seen) > 0.0));
  const SE3 T_first_frame = T_camera_world(0) * T_camera_world(39).inverse();
  EXPECT_LT((pose.inverse() * T_first_frame).log().norm(), 0.01);
}

/// A sensor that sees a quarter of the image, and scatters wild depths over the rest: where nothing else has
/// depth, poses would rest on them.
TEST_F(VisualOdometryTest, PosesDoNotRestOnWildDepths) {
  VisualOdometry odometry(scene_.camera(), options_);
  cv::RNG random(1);
  double largest = 0.0;
  for (int i = 0; i < 25; ++i) {
    RgbdFrame given = frame(i);
    for (int y = 0; y < given.depth.rows; ++y) {
      for (int x = given.depth.cols / 4; x < given.depth.cols; ++x)
        given.depth(y, x) = random.uniform(0.0, 1.0) < 0.07 ? random.uniform(0.45F, 0.9F) : kNoDepth;
    }
    const TrackingResult tracked = odometry.track(given);
    odometry.map();
    ASSERT_EQ(tracked.state, TrackingState::kTracking) << i;
    const SE3 T_first_frame = T_camera_world(0) * T_camera_world(i).inverse();
    largest = std::max(largest, (tracked.T_first_frame.inverse() * T_first_frame).log().norm());
  }
  EXPECT_LT(largest, 0.02);
}

TEST_F(VisualOdometryTest, FollowsTheCameraAndMapsThePlane) {
  for (const bool feedback : {false, true}) {
    options_.sensor_feedback = feedback;
    VisualOdometry odometry(scene_.camera(), options_);
    const SE3 T_first_world = T_camera_world(0);
    std::shared_ptr<const KeyframeMap> map;
    for (int i = 0; i < 30; ++i) {
      const TrackingResult tracked = odometry.track(frame(i));
      map = odometry.map();
      ASSERT_EQ(tracked.state, TrackingState::kTracking) << i;
      const SE3 T_first_frame = T_first_world * T_camera_world(i).inverse();
      EXPECT_LT((tracked.T_first_frame.inverse() * T_first_frame).log().norm(), 0.006) << i;
    }
    ASSERT_TRUE(map);
    int count = 0, good = 0;
    const SE3 T_keyframe_world = map->T_first_keyframe.inverse() * T_first_world;
    for (int v = 0; v < map->depth.mean.rows; ++v) {
      for (int u = 0; u < map->depth.mean.cols; ++u) {
        const double depth = static_cast<double>(map->depth.mean(v, u));
        ASSERT_EQ(std::isnan(depth), std::isnan(map->depth.variance(v, u)));
        if (!(depth > 0.0)) continue;
        ASSERT_GT(map->depth.variance(v, u), 0.0F);
        const double truth = scene_.depth(T_keyframe_world, u, v);
        ++count;
        good += std::abs(depth - truth) < 0.05 * truth ? 1 : 0;
      }
    }
    EXPECT_GT(count, 8000);
    EXPECT_GT(good, 0.9 * count);
  }
}

/// A turn on the spot has no parallax, and in the end nothing is in view that the sensor saw at the start.
TEST_F(VisualOdometryTest, FollowsATurnAwayFromAllThatIsKnown) {
  options_.sensor_feedback = false;
  VisualOdometry odometry(scene_.camera(), options_);
  const auto turned = [](int index) { return motion(0, 0, 0, 0, -0.6 + 0.04 * index, 0); };
  for (int i = 0; i <= 28; ++i) {
    const TrackingResult tracked =
        odometry.track(scene_.frame((i + 1) * kPeriod, turned(i), 2.0, static_cast<std::uint64_t>(i) + 1));
    ASSERT_EQ(tracked.state, TrackingState::kTracking) << i;
    odometry.map();
    const SE3 T_frame_first = turned(i) * turned(0).inverse();
    const Vector6 error = (tracked.T_first_frame * T_frame_first).log();
    EXPECT_LT(error.head<3>().norm(), 0.03) << i;
    EXPECT_LT(error.tail<3>().norm(), 0.015) << i;
  }
}

TEST_F(VisualOdometryTest, AFrameThatBecomesAKeyframeNamesItself) {
  options_.keyframe.max_distance = 0.02F;
  VisualOdometry odometry(scene_.camera(), options_);
  int keyframes = 0;
  for (int i = 0; i < 12; ++i) {
    const TrackingResult tracked = odometry.track(frame(i));
    const std::shared_ptr<const KeyframeMap> map = odometry.map();
    ASSERT_TRUE(map);
    EXPECT_EQ(map->stamp, tracked.keyframe_stamp);
    if (tracked.keyframe_stamp != tracked.stamp) continue;
    ++keyframes;
    EXPECT_EQ(tracked.T_frame_keyframe.log().norm(), 0.0);
    EXPECT_EQ(tracked.keyframe_revision, 0U);
    EXPECT_EQ(map->stamp, tracked.stamp);
    EXPECT_EQ(map->revision, 0U);
  }
  EXPECT_GE(keyframes, 3);
}

TEST_F(VisualOdometryTest, IsDeterministic) {
  VisualOdometry first(scene_.camera(), options_), second(scene_.camera(), options_);
  for (int i = 0; i < 8; ++i) {
    const TrackingResult a = first.track(frame(i)), b = second.track(frame(i));
    EXPECT_TRUE(a.T_first_frame.translation() == b.T_first_frame.translation());
    EXPECT_TRUE(sameBits(first.map()->depth.mean, second.map()->depth.mean));
  }
}

TEST_F(VisualOdometryTest, WaitsForDepthAndTexture) {
  VisualOdometry odometry(scene_.camera(), options_);
  RgbdFrame blind = frame(0);
  blind.depth.release();
  EXPECT_EQ(odometry.track(blind).state, TrackingState::kInitialising);
  EXPECT_FALSE(odometry.map());
  RgbdFrame empty_depth = frame(1);
  empty_depth.depth.setTo(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(odometry.track(empty_depth).state, TrackingState::kInitialising);
  RgbdFrame wild = frame(1);
  wild.stamp = wild.depth_stamp = frame(1).stamp + 1;
  cv::RNG random(1);
  for (float& depth : wild.depth) depth = random.uniform(0.5F, 40.0F);
  EXPECT_EQ(odometry.track(wild).state, TrackingState::kInitialising);
  RgbdFrame blank = frame(2);
  blank.grey.setTo(128);
  EXPECT_EQ(odometry.track(blank).state, TrackingState::kInitialising);
  EXPECT_EQ(odometry.track(frame(3)).state, TrackingState::kTracking);
}

TEST_F(VisualOdometryTest, StartsWithoutDepthWhenAskedTo) {
  options_.init = Initialisation::kRandom;
  options_.sensor_feedback = false;
  VisualOdometry odometry(scene_.camera(), options_);
  RgbdFrame blind = frame(0);
  blind.depth.release();
  EXPECT_EQ(odometry.track(blind).state, TrackingState::kTracking);
  EXPECT_TRUE(odometry.map());
}

/// Sensor depth is in metres, which is another unit.
TEST_F(VisualOdometryTest, AfterARandomStartSensorDepthDoesNotChangeTheUnit) {
  options_.init = Initialisation::kRandom;
  options_.keyframe.max_distance = 0.02F;
  ASSERT_TRUE(options_.sensor_feedback);
  OdometryOptions alone = options_;
  alone.sensor_feedback = false;
  VisualOdometry odometry(scene_.camera(), options_), without_feedback(scene_.camera(), alone);
  std::uint64_t keyframes = 0;
  for (int i = 0; i < 25; ++i) {
    const TrackingResult tracked = odometry.track(frame(i)), expected = without_feedback.track(frame(i));
    odometry.map();
    without_feedback.map();
    keyframes += tracked.keyframe_stamp == tracked.stamp ? 1 : 0;
    EXPECT_EQ(tracked.T_first_frame.log(), expected.T_first_frame.log()) << i;
  }
  EXPECT_GT(keyframes, 2U);
}

/// The camera turns faster and faster, and goes on turning as fast while one frame does not come.
TEST_F(VisualOdometryTest, GoesOnAsFastWhereAFrameIsMissing) {
  VisualOdometry odometry(scene_.camera(), options_);
  double angle = 0.0;
  for (int i = 0; i < 10; ++i) {
    angle += std::min(0.11 * i, 0.5);
    if (i == 7) continue;
    const RgbdFrame turned =
        scene_.frame((i + 1) * kPeriod, motion(0, 0, 0, 0, 0, angle), 2.0, static_cast<std::uint64_t>(i) + 1);
    EXPECT_EQ(odometry.track(turned).state, TrackingState::kTracking) << i;
    odometry.map();
  }
}

TEST_F(VisualOdometryTest, CovariancesAreNeverSingularAndAddUp) {
  options_.keyframe.max_distance = 0.02F;
  VisualOdometry odometry(scene_.camera(), options_);
  double uncertainty = 0.0;
  for (int i = 0; i < 12; ++i) {
    const TrackingResult tracked = odometry.track(frame(i));
    odometry.map();
    for (const Matrix6& covariance : {tracked.covariance, tracked.pose_covariance}) {
      const Eigen::SelfAdjointEigenSolver<Matrix6> solver(covariance);
      EXPECT_GT(solver.eigenvalues().minCoeff(), 0.0) << i;
    }
    if (tracked.keyframe_stamp != tracked.stamp) continue;
    EXPECT_GE(tracked.pose_covariance.trace(), 0.99 * uncertainty) << i;
    uncertainty = tracked.pose_covariance.trace();
  }
  EXPECT_GT(uncertainty, 1e-8);
}

TEST_F(VisualOdometryTest, RefusesWhatDoesNotFit) {
  VisualOdometry odometry(scene_.camera(), options_);
  RgbdFrame small = frame(0);
  small.grey = GreyImage(10, 10);
  EXPECT_THROW(odometry.track(small), std::invalid_argument);
  RgbdFrame small_depth = frame(0);
  small_depth.depth = DepthImage(10, 10);
  EXPECT_THROW(odometry.track(small_depth), std::invalid_argument);
  RgbdFrame part = frame(0);
  part.grey = GreyImage(cv::Size(part.grey.cols + 16, part.grey.rows), 0.0F).colRange(0, part.grey.cols);
  EXPECT_THROW(odometry.track(part), std::invalid_argument) << "rows that do not follow each other";
  RgbdFrame seen = frame(0);
  seen.seen = cv::Rect(8, 0, seen.grey.cols, seen.grey.rows);
  EXPECT_THROW(odometry.track(seen), std::invalid_argument);
  RgbdFrame without_stamp = frame(0);
  without_stamp.depth_stamp = kNoStamp;
  EXPECT_THROW(odometry.track(without_stamp), std::invalid_argument);
  odometry.track(frame(3));
  odometry.map();
  EXPECT_THROW(odometry.track(frame(3)), std::invalid_argument);
  EXPECT_THROW(odometry.track(frame(2)), std::invalid_argument);
  EXPECT_EQ(odometry.track(frame(4)).state, TrackingState::kTracking);
  odometry.reset();
  EXPECT_EQ(odometry.track(frame(0)).state, TrackingState::kTracking);
  OdometryOptions bad = options_;
  bad.tracking.pyramid_levels = 7;
  EXPECT_THROW(odometry.setOptions(bad), std::invalid_argument);
  EXPECT_THROW(VisualOdometry(scene_.camera(), bad), std::invalid_argument);
  bad = options_;
  bad.mapping.epipolar_noise = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(odometry.setOptions(bad), std::invalid_argument);
  PinholeCamera flat = scene_.camera();
  flat.fx = 0.0;
  EXPECT_THROW(VisualOdometry(flat, options_), std::invalid_argument);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
