// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/tracking_depth.h"

#include <gtest/gtest.h>

#include <limits>
#include <opencv2/core.hpp>

namespace rgbd_sfm_fusion {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr float kRho = 0.5F, kVariance = 1e-4F;  // [1/m], [1/m²] of stereo

class TrackingDepthTest : public testing::Test {
 protected:
  TrackingDepthTest() {
    nothing_.create(size_);
    nothing_.clear();
  }

  const PinholeCamera camera_{160, 120, 130.0, 130.0, 79.5, 59.5};
  const cv::Size size_{160, 120};

  InverseDepthImage stereo() const {
    InverseDepthImage stereo;
    stereo.create(size_);
    stereo.mean.setTo(kRho);
    stereo.variance.setTo(kVariance);
    return stereo;
  }

  /// Depth of the whole image, a tenth too far in a square.
  GaussianDepth falseInASquare() const {
    GaussianDepth depth{DepthImage(size_, 1.0F / kRho), cv::Mat_<float>(size_, 1e-4F)};
    depth.mean(cv::Rect(32, 32, 32, 32)).setTo(1.1 / static_cast<double>(kRho));
    return depth;
  }

  /// Depth of the left half.
  GaussianDepth sensor() const {
    GaussianDepth depth{DepthImage(size_, kNone), cv::Mat_<float>(size_, kNone)};
    depth.mean.colRange(0, 80).setTo(1.0F / kRho);
    depth.variance.colRange(0, 80).setTo(1e-4F);
    return depth;
  }

  const InverseDepthWarp nowhere_{camera_, SE3(), ReadoutMotion(), ReadoutMotion()};
  InverseDepthImage nothing_;
  const cv::Mat_<float> exact_{size_, 0.0F};  // stereo's poses
};

TEST_F(TrackingDepthTest, BesideTheSensorStereoCountsAnErrorOfPosesForAllPointsThatShareIt) {
  const cv::Mat_<float> by_pose(size_, 0.01F);
  TrackingDepth depth(camera_);
  depth.setSensor(sensor());
  const InverseDepthImage& fused = depth.fuse({stereo(), by_pose, 1000.0F}, 0.0);
  EXPECT_FLOAT_EQ(fused.mean(60, 20), kRho);
  EXPECT_FLOAT_EQ(fused.mean(60, 140), kRho);
  EXPECT_LT(fused.variance(60, 20), kVariance);
  EXPECT_FLOAT_EQ(fused.variance(60, 140), kVariance + 1000.0F * 1e-4F);
}

TEST_F(TrackingDepthTest, WithoutAnySensorAllStereoIsAlike) {
  TrackingDepth depth(camera_);
  EXPECT_FLOAT_EQ(depth.fuse({stereo(), exact_, 1.0F}, 0.0).variance(60, 140), kVariance);
  depth.setSensor(sensor());
  depth.clear();
  EXPECT_FLOAT_EQ(depth.fuse({stereo(), exact_, 1.0F}, 0.0).variance(60, 140), kVariance);
  EXPECT_FLOAT_EQ(depth.fuse({stereo(), exact_, 1.0F}, 0.0).variance(60, 20), kVariance);
}

/// In a square of 32 px, tracking has 512 points.
TEST_F(TrackingDepthTest, ErrorsOfPosesCountForAllPointsThatShareThemOnceTheSensorIsGone) {
  const cv::Mat_<float> by_pose(size_, 0.01F);
  TrackingDepth depth(camera_);
  EXPECT_FLOAT_EQ(depth.fuse({stereo(), by_pose, 1000.0F}, 0.0).variance(60, 140), kVariance)
      << "none before";
  depth.setSensor(sensor());
  depth.fuse({nothing_, exact_, 1.0F}, 0.0);
  depth.moveTo(nowhere_);  // the right half has no depth
  EXPECT_FLOAT_EQ(depth.fuse({stereo(), exact_, 1.0F}, 0.0).variance(60, 140), kVariance);
  EXPECT_FLOAT_EQ(depth.fuse({stereo(), by_pose, 1000.0F}, 0.0).variance(60, 140),
                  kVariance + 512.0F * 1e-4F);
}

/// It is anywhere between infinity and the mean of what is known. The points of a square are wrong together.
TEST_F(TrackingDepthTest, WhatTheSensorDoesNotSeeIsExpectedBehind) {
  TrackingDepth depth(camera_);
  depth.setSensor(sensor());
  EXPECT_EQ(depth.fuse({nothing_, exact_, 1.0F}, 0.0).mean(60, 140), 0.0F);
  const InverseDepthImage& expected = depth.expectRest();
  EXPECT_FLOAT_EQ(expected.mean(60, 140), 0.5F * kRho);
  EXPECT_FLOAT_EQ(expected.variance(60, 140), 512.0F * kRho * kRho / 12.0F);
  EXPECT_EQ(expected.mean(60, 90), 0.0F) << "in a square of which something is known";
  EXPECT_FLOAT_EQ(expected.mean(60, 20), kRho);
  EXPECT_LT(expected.variance(60, 20), 0.01F * kRho * kRho);
  EXPECT_FLOAT_EQ(depth.fuse({stereo(), exact_, 1.0F}, 0.0).variance(60, 140), kVariance) << "no measurement";
  depth.expectRest();
  depth.moveTo(nowhere_);
  EXPECT_FLOAT_EQ(depth.fuse({nothing_, exact_, 1.0F}, 0.0).mean(60, 140), kRho) << "carried over";
}

/// Stereo has found where the scene is that the sensor does not see, but not everywhere.
TEST_F(TrackingDepthTest, WhatTheSensorDoesNotSeeIsExpectedWhereItWasElsewhere) {
  InverseDepthImage some = nothing_;
  some.mean(cv::Rect(80, 0, 48, 120)).setTo(0.2F * kRho);
  some.variance(cv::Rect(80, 0, 48, 120)).setTo(kVariance);
  TrackingDepth depth(camera_);
  depth.setSensor(sensor());
  depth.fuse({some, exact_, 1.0F}, 0.0);
  depth.moveTo(nowhere_);
  depth.setSensor(sensor());
  depth.fuse({nothing_, exact_, 1.0F}, 0.0);
  EXPECT_NEAR(depth.expectRest().mean(60, 140), 0.2F * kRho, 0.03F * kRho);
  EXPECT_LT(depth.expectRest().variance(60, 140), 512.0F * kRho * kRho / 100.0F);
}

/// A mapper renews the bands of rows in turn.
TEST_F(TrackingDepthTest, WhatIsExpectedStaysUntilItsBandIsRenewed) {
  TrackingDepth depth(camera_);
  depth.setSensor(sensor());
  depth.fuse({nothing_, exact_, 1.0F}, 0.0);
  depth.expectRest();
  const RowBands even{0, 2};  // 0 to 31 and 64 to 95
  depth.fuse({stereo(), exact_, 1.0F}, 0.0, even);
  const InverseDepthImage& renewed = depth.expectRest(even);
  EXPECT_FLOAT_EQ(renewed.mean(70, 140), kRho);
  EXPECT_FLOAT_EQ(renewed.mean(40, 140), 0.5F * kRho);
  EXPECT_FLOAT_EQ(renewed.mean(119, 140), 0.5F * kRho);
  depth.moveTo(nowhere_);
  const InverseDepthImage& carried = depth.fuse({nothing_, exact_, 1.0F}, 0.0);
  EXPECT_FLOAT_EQ(carried.mean(70, 140), kRho);
  EXPECT_EQ(carried.mean(40, 140), 0.0F);
  EXPECT_EQ(carried.mean(119, 140), 0.0F);
}

/// Neither sensor, nor stereo, nor what is expected gives a depth to what is not of the scene.
TEST_F(TrackingDepthTest, SquaresThatAreLeftOutHaveNoDepth) {
  cv::Mat_<std::uint8_t> squares(8, 10, std::uint8_t{0});
  squares(3, 1) = squares(3, 8) = 1;  // of what the sensor sees, and of what it does not see
  TrackingDepth depth(camera_);
  depth.setSensor(sensor());
  depth.leaveOut(squares);
  depth.fuse({stereo(), exact_, 1.0F}, 0.0);
  const InverseDepthImage& left = depth.expectRest();
  for (const int u : {16, 31, 128, 143}) EXPECT_EQ(left.mean(60, u), 0.0F) << u;
  for (const int u : {15, 32, 127, 144}) EXPECT_GT(left.mean(60, u), 0.0F) << u;
  depth.leaveOut({});
  EXPECT_GT(depth.fuse({stereo(), exact_, 1.0F}, 0.0).mean(60, 16), 0.0F);
}

/// A gripper in front of the camera does not make the scene nearer.
TEST_F(TrackingDepthTest, NothingIsExpectedByWhatIsLeftOut) {
  cv::Mat_<std::uint8_t> squares(8, 10, std::uint8_t{0});
  squares.colRange(0, 2).setTo(1);
  GaussianDepth with_gripper = sensor();
  with_gripper.mean.colRange(0, 32) = with_gripper.mean.colRange(0, 32) * 0.2;
  TrackingDepth depth(camera_);
  depth.leaveOut(squares);
  depth.setSensor(with_gripper);
  depth.fuse({nothing_, exact_, 1.0F}, 0.0);
  EXPECT_FLOAT_EQ(depth.expectRest().mean(60, 140), 0.5F * kRho);
}

TEST_F(TrackingDepthTest, WithoutTheSensorTheSceneIsExpectedToGoOn) {
  TrackingDepth depth(camera_);
  depth.setSensor(sensor());
  depth.fuse({nothing_, exact_, 1.0F}, 0.0);
  depth.expectRest();
  depth.moveTo(nowhere_);
  EXPECT_EQ(depth.fuse({nothing_, exact_, 1.0F}, 0.0).mean(60, 140), 0.0F) << "not carried over";
  EXPECT_NEAR(depth.expectRest().mean(60, 140), kRho, 0.03F * kRho);
  EXPECT_GT(depth.expectRest().variance(60, 140), kRho * kRho) << "which says little";
  depth.clear();
  depth.fuse({nothing_, exact_, 1.0F}, 0.0);
  EXPECT_EQ(depth.expectRest().mean(60, 140), 0.0F) << "after a new start";
}

/// A sensor that sees nothing sends images all the same.
TEST_F(TrackingDepthTest, AnImageWithoutDepthIsNoSensorDepth) {
  const cv::Mat_<float> by_pose(size_, 0.01F);
  const GaussianDepth empty{DepthImage(size_, kNone), cv::Mat_<float>(size_, kNone)};
  TrackingDepth depth(camera_);
  depth.setSensor(sensor());
  depth.fuse({nothing_, exact_, 1.0F}, 0.0);
  depth.moveTo(nowhere_);
  depth.setSensor(empty);
  depth.contestByCarried(1.0);
  EXPECT_FLOAT_EQ(depth.fuse({nothing_, exact_, 1.0F}, 1.0).mean(60, 20), kRho) << "carried over";
  EXPECT_FLOAT_EQ(depth.fuse({stereo(), by_pose, 1e4F}, 1.0).variance(60, 140), kVariance + 512.0F * 1e-4F)
      << "as without an image";
  EXPECT_GT(depth.independentShare(), 0.2F);
}

TEST_F(TrackingDepthTest, StereoAloneHasErrorsOfItsOwn) {
  TrackingDepth depth(camera_);
  depth.setSensor(sensor());
  EXPECT_EQ(depth.independentShare(), 0.0F);
  depth.fuse({stereo(), exact_, 1.0F}, 1.0);
  depth.moveTo(nowhere_);
  EXPECT_GT(depth.independentShare(), 0.2F);
  EXPECT_LT(depth.independentShare(), 0.5F);
}

TEST_F(TrackingDepthTest, NoiseDoesNotDrawCarriedDepthNearer) {
  InverseDepthImage noisy = stereo();
  cv::Mat_<float> noise(size_);
  cv::RNG random(1);
  random.fill(noise, cv::RNG::NORMAL, 0.0, 0.05 * static_cast<double>(kRho));
  noisy.mean += noise;
  noisy.variance.setTo(0.0025F * kRho * kRho);
  TrackingDepth depth(camera_);
  depth.fuse({noisy, exact_, 1.0F}, 1.0);
  // A step back: several estimates of the plane come to one pixel.
  const SE3 back(Eigen::Quaterniond::Identity(), {0.0, 0.0, 1.0});
  depth.moveTo(InverseDepthWarp(camera_, back, ReadoutMotion(), ReadoutMotion()));
  const cv::Mat_<float>& carried = depth.fuse({nothing_, exact_, 1.0F}, 1.0).mean;
  ASSERT_GT(cv::countNonZero(carried), 7000);
  EXPECT_NEAR(cv::mean(carried, carried > 0.0F)[0], 1.0 / (1.0 / static_cast<double>(kRho) + 1.0), 0.001);
}

TEST_F(TrackingDepthTest, OfTwoSurfacesTheNearerOneIsCarried) {
  InverseDepthImage surfaces = stereo();
  for (int u = 0; u < size_.width; u += 2) surfaces.mean.col(u).setTo(2.0F * kRho);
  TrackingDepth depth(camera_);
  depth.fuse({surfaces, exact_, 1.0F}, 1.0);
  const SE3 aside(Eigen::Quaterniond::Identity(), {1.0 / 130.0 / static_cast<double>(kRho), 0.0, 0.0});
  // The near surface moves by two pixels, the far one by one.
  depth.moveTo(InverseDepthWarp(camera_, aside, ReadoutMotion(), ReadoutMotion()));
  EXPECT_FLOAT_EQ(depth.fuse({nothing_, exact_, 1.0F}, 1.0).mean(60, 80), 2.0F * kRho);
}

TEST_F(TrackingDepthTest, CarriedDepthThatIsDroppedContestsFalseSensorDepthAndNoMore) {
  TrackingDepth depth(camera_);
  depth.fuse({stereo(), exact_, 1.0F}, 1.0);
  depth.moveTo(nowhere_);
  GaussianDepth sensor = falseInASquare();
  sensor.mean(cv::Rect(96, 32, 32, 32)).setTo(kNone);
  depth.setSensor(sensor, TrackingDepth::Carried::kIsDropped);
  depth.contestByCarried(1.0);
  const InverseDepthImage& fused = depth.fuse({nothing_, exact_, 1.0F}, 1.0);
  EXPECT_EQ(fused.mean(48, 48), 0.0F);
  EXPECT_FLOAT_EQ(fused.mean(10, 10), kRho);
  EXPECT_EQ(fused.mean(48, 112), 0.0F);
}

/// The skew is redone once the keyframe's motion is known.
TEST_F(TrackingDepthTest, SensorDepthThatIsSetAnewTakesNothingFromTheFirst) {
  TrackingDepth depth(camera_);
  depth.setSensor(sensor());
  GaussianDepth narrower = sensor();
  narrower.mean.colRange(70, 80).setTo(kNone);
  depth.setSensor(narrower);
  const InverseDepthImage& fused = depth.fuse({nothing_, exact_, 1.0F}, 0.0);
  EXPECT_FLOAT_EQ(fused.mean(60, 65), kRho);
  EXPECT_EQ(fused.mean(60, 75), 0.0F);
}

TEST_F(TrackingDepthTest, SensorDepthThatIsSetAnewIsContestedByTheSameCarriedDepth) {
  TrackingDepth depth(camera_);
  depth.fuse({stereo(), exact_, 1.0F}, 1.0);
  depth.moveTo(nowhere_);
  for (int i = 0; i < 2; ++i) {
    depth.setSensor(falseInASquare());
    depth.contestByCarried(1.0);
    EXPECT_EQ(depth.fuse({nothing_, exact_, 1.0F}, 1.0).mean(48, 48), 0.0F);
    EXPECT_FLOAT_EQ(depth.fuse({nothing_, exact_, 1.0F}, 1.0).mean(10, 10), kRho);
  }
}

TEST_F(TrackingDepthTest, ASharedErrorIsCountedOnceHoweverOftenDepthIsCarriedOver) {
  const cv::Mat_<float> by_pose(size_, 0.01F);
  TrackingDepth depth(camera_);
  depth.setSensor(sensor());
  const float once = depth.fuse({stereo(), by_pose, 1000.0F}, 0.0).variance(60, 140);
  for (int i = 0; i < 4; ++i) {
    depth.moveTo(nowhere_);
    if (i != 3) depth.setSensor(sensor());  // a keyframe without sensor depth does not know better
    EXPECT_NEAR(depth.fuse({nothing_, exact_, 1000.0F}, 0.0).variance(60, 140), once, 0.1F * once) << i;
    EXPECT_LT(depth.fuse({nothing_, exact_, 1000.0F}, 0.0).variance(60, 20), 0.1F * once) << i;
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
