// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "rgbd_sfm_fusion/mapping/row_bands.h"
#include "synthetic_views.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr Stamp kPeriod = 33'000'000;

class VisualOdometryTest : public testing::Test {
 protected:
  VisualOdometryTest() { options_.tracking.pyramid_levels = 4; }

  /// A sway of 12 cm, with some turning.
  static SE3 T_camera_world(int frame) {
    const double phase = 0.1 * frame;
    return motion(0.12 * std::sin(phase), 0.05 * std::sin(0.7 * phase), 0.06 * std::sin(0.5 * phase),
                  0.01 * phase, -0.02 * std::sin(phase), 0.01 * std::sin(phase));
  }

  RgbdFrame frame(int index) const {
    return scene_.frame((index + 1) * kPeriod, T_camera_world(index), 2.0,
                        static_cast<std::uint64_t>(index) + 1);
  }

  PlaneScene scene_{smallCamera()};
  OdometryOptions options_;
};

bool sameBits(const cv::Mat_<float>& a, const cv::Mat_<float>& b) {
  return a.size() == b.size() && std::memcmp(a[0], b[0], a.total() * sizeof(float)) == 0;
}

TEST_F(VisualOdometryTest, SmallImagesAreTrackedAtFullResolution) {
  const auto poseAfter = [&](int finest_level) {
    options_.tracking.finest_level = finest_level;
    VisualOdometry odometry(scene_.camera(), options_);
    TrackingResult tracked;
    for (int i = 0; i < 8; ++i) {
      tracked = odometry.track(frame(i));
      odometry.map();
    }
    return tracked.T_odom_frame;
  };
  const SE3 full = poseAfter(0), half = poseAfter(1);
  EXPECT_EQ(half.translation(), full.translation()) << "half of 320 x 240 is too little to track on";
  EXPECT_EQ(half.rotation().coeffs(), full.rotation().coeffs());
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
    return std::make_pair(tracked.T_odom_frame, map->depth);
  };
  const auto [pose, depth] = run(1);
  const auto [other_pose, other_depth] = run(2);
  EXPECT_EQ((pose.inverse() * other_pose).log().norm(), 0.0);
  EXPECT_EQ(cv::countNonZero(depth.mean > 0.0), cv::countNonZero(other_depth.mean > 0.0));
  EXPECT_GT(cv::countNonZero(depth.mean(seen) > 0.0), 1000);
  EXPECT_EQ(cv::countNonZero(depth.mean > 0.0), cv::countNonZero(depth.mean(seen) > 0.0));
  const SE3 T_odom_frame = T_camera_world(0) * T_camera_world(39).inverse();
  EXPECT_LT((pose.inverse() * T_odom_frame).log().norm(), 0.01);
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
      const SE3 T_odom_frame = T_first_world * T_camera_world(i).inverse();
      EXPECT_LT((tracked.T_odom_frame.inverse() * T_odom_frame).log().norm(), 0.006) << i;
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

TEST_F(VisualOdometryTest, SmoothingWhatIsPublishedMovesNoPoseAndMakesItBetter) {
  OdometryOptions rough_options = options_;
  rough_options.mapping.smooth_published = false;
  VisualOdometry smooth(scene_.camera(), options_), rough(scene_.camera(), rough_options);
  std::shared_ptr<const KeyframeMap> smoothed, raw;
  for (int i = 0; i < 20; ++i) {
    const TrackingResult a = smooth.track(frame(i)), b = rough.track(frame(i));
    ASSERT_EQ(a.T_odom_frame.log(), b.T_odom_frame.log()) << i;
    smoothed = smooth.map();
    raw = rough.map();
  }
  EXPECT_EQ(cv::countNonZero((smoothed->depth.mean > 0.0F) != (raw->depth.mean > 0.0F)), 0);
  const SE3 T_keyframe_world = raw->T_first_keyframe.inverse() * T_camera_world(0);
  double smoothed_error = 0.0, raw_error = 0.0;
  for (int v = 0; v < raw->depth.mean.rows; ++v) {
    for (int u = 0; u < raw->depth.mean.cols; ++u) {
      if (!(raw->depth.mean(v, u) > 0.0F)) continue;
      const double truth = scene_.depth(T_keyframe_world, u, v);
      smoothed_error += std::abs(static_cast<double>(smoothed->depth.mean(v, u)) / truth - 1.0);
      raw_error += std::abs(static_cast<double>(raw->depth.mean(v, u)) / truth - 1.0);
    }
  }
  EXPECT_LT(smoothed_error, 0.95 * raw_error);
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

TEST_F(VisualOdometryTest, FramesAreTrackedAgainstTheMapOfTwoFramesBefore) {
  options_.keyframe.max_distance = 0.03F;
  for (const auto& [period, lag] : {std::pair<Stamp, std::uint32_t>(kPeriod, 2), {6 * kPeriod, 1}}) {
    VisualOdometry odometry(scene_.camera(), options_);
    int keyframes = 0;
    std::uint32_t after_keyframe = 0;
    for (int i = 0; i < 24; ++i) {
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
    poses.push_back(odometry.track(frame).T_odom_frame);
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
    EXPECT_EQ(tracked.T_odom_frame.translation(), poses[i].translation()) << i;
    EXPECT_EQ(tracked.T_odom_frame.rotation().coeffs(), poses[i].rotation().coeffs()) << i;
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
    const SE3 T_odom_frame = T_camera_world(0) * T_camera_world(i).inverse();
    EXPECT_LT((tracked.T_odom_frame.inverse() * T_odom_frame).log().norm(), 0.01) << i;
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

TEST_F(VisualOdometryTest, IsDeterministic) {
  VisualOdometry first(scene_.camera(), options_), second(scene_.camera(), options_);
  for (int i = 0; i < 8; ++i) {
    const TrackingResult a = first.track(frame(i)), b = second.track(frame(i));
    EXPECT_TRUE(a.T_odom_frame.translation() == b.T_odom_frame.translation());
    EXPECT_TRUE(sameBits(first.map()->depth.mean, second.map()->depth.mean));
  }
}

TEST_F(VisualOdometryTest, MonocularStereoNeverSeesLaterSensorDepth) {
  options_.sensor_feedback = false;
  VisualOdometry honest(scene_.camera(), options_), falsified(scene_.camera(), options_);
  for (int i = 0; i < 20; ++i) {
    RgbdFrame false_frame = frame(i);
    if (i > 0) false_frame.depth *= 1.1;
    honest.track(frame(i));
    falsified.track(false_frame);
    const auto a = honest.map(), b = falsified.map();
    ASSERT_TRUE(sameBits(a->depth.mean, b->depth.mean)) << i;
    ASSERT_TRUE(sameBits(a->depth.variance, b->depth.variance)) << i;
  }
}

TEST_F(VisualOdometryTest, PublishesNothingFromSensorDepthAlone) {
  VisualOdometry odometry(scene_.camera(), options_);
  // A camera that stands still or turns has no parallax, whatever the sensor sees.
  for (int i = 0; i < 8; ++i) {
    odometry.track(scene_.frame((i + 1) * kPeriod, motion(0, 0, 0, 0, 0.004 * i, 0), 2.0,
                                static_cast<std::uint64_t>(i) + 1));
    const auto map = odometry.map();
    ASSERT_TRUE(map);
    cv::Mat has_depth = map->depth.mean > 0.0;
    EXPECT_LT(cv::countNonZero(has_depth), 500) << i;
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
  const SE3 T_odom_frame = T_camera_world(0) * T_camera_world(8).inverse();
  EXPECT_LT((back.T_odom_frame.inverse() * T_odom_frame).log().norm(), 0.01);
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
    const SE3 T_odom_frame = T_camera_world(0) * T.inverse();
    EXPECT_LT((back.T_odom_frame.inverse() * T_odom_frame).log().norm(), 0.02) << turn;
  }
}

TEST_F(VisualOdometryTest, FindsAPlaceOfARecentKeyframe) {
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
    const double far = tracked.T_odom_frame.translation().x();
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
    EXPECT_LT((back.T_odom_frame.inverse() * T.inverse()).log().norm(), 0.03) << feedback;
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
  EXPECT_GT(std::sqrt(tracked.odom_covariance.diagonal().minCoeff()), 0.3);
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
  const SE3 T_odom_frame = T_camera_world(0) * T.inverse();
  EXPECT_LT((back.T_odom_frame.inverse() * T_odom_frame).log().norm(), 0.02);
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
      EXPECT_LT((tracked.T_odom_frame.inverse() * at(i).inverse()).log().norm(), 0.03) << i;
    }
  }
  EXPECT_GT(keyframes_without, 0);
  EXPECT_GT(keyframes_after, 0);
}

TEST_F(VisualOdometryTest, CovariancesAreNeverSingularAndAddUp) {
  options_.keyframe.max_distance = 0.02F;
  VisualOdometry odometry(scene_.camera(), options_);
  double uncertainty = 0.0;
  for (int i = 0; i < 12; ++i) {
    const TrackingResult tracked = odometry.track(frame(i));
    odometry.map();
    for (const Matrix6& covariance : {tracked.covariance, tracked.odom_covariance}) {
      const Eigen::SelfAdjointEigenSolver<Matrix6> solver(covariance);
      EXPECT_GT(solver.eigenvalues().minCoeff(), 0.0) << i;
    }
    if (tracked.keyframe_stamp != tracked.stamp) continue;
    EXPECT_GE(tracked.odom_covariance.trace(), 0.99 * uncertainty) << i;
    uncertainty = tracked.odom_covariance.trace();
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
  const double before = tracked.odom_covariance.diagonal().head<3>().maxCoeff();
  options_.tracking.pyramid_levels = 3;
  odometry.setOptions(options_);
  tracked = odometry.track(frame(4));
  EXPECT_EQ(tracked.state, TrackingState::kTracking);
  EXPECT_EQ(tracked.keyframe_stamp, tracked.stamp);
  EXPECT_TRUE(tracked.relocalised);
  EXPECT_GT(tracked.odom_covariance.diagonal().head<3>().minCoeff(), before + 0.01);
}

/// Of a camera that hardly moves, a few bands of rows are enough in each frame; the others stay.
TEST_F(VisualOdometryTest, AFrameOfASlowCameraRenewsAPartOfTheMap) {
  VisualOdometry odometry(scene_.camera(), options_);
  std::shared_ptr<const KeyframeMap> before, map;
  std::vector<bool> changed(static_cast<std::size_t>(scene_.camera().height / RowBands::kRows + 1), false);
  for (int i = 0; i < 16; ++i) {
    const SE3 T = motion(0.004 * i, 0, 0);
    odometry.track(scene_.frame((i + 1) * kPeriod, T, 2.0, static_cast<std::uint64_t>(i)));
    before = map;
    map = odometry.map();
    if (i < 12) continue;
    std::size_t rows = 0;
    for (int v = 0; v < map->depth.mean.rows; ++v) {
      if (sameBits(map->depth.mean.row(v), before->depth.mean.row(v))) continue;
      ++rows;
      changed[static_cast<std::size_t>(v / RowBands::kRows)] = true;
    }
    EXPECT_GT(rows, 0U) << i;
    EXPECT_LE(rows, 3U * RowBands::kRows) << i;
  }
  EXPECT_GT(std::count(changed.begin(), changed.end(), true), 6);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
