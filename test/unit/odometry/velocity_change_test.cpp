// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/velocity_change.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rgbd_sfm_fusion {
namespace {

constexpr double kInterval = 0.033;  // [s]
constexpr double kReadout = 0.028;   // [s]

TEST(VelocityChange, IsNothingWhileTheVelocityStaysTheSame) {
  VelocityChange change;
  Vector6 twist;
  twist << 0.01, 0.0, 0.02, 0.0, 0.03, 0.0;
  for (int i = 0; i < 5; ++i) change.observe({twist, kInterval});
  const Vector6 velocity = twist / kInterval, still = Vector6::Zero();
  EXPECT_NEAR(change.duringReadout(velocity, still, kReadout, 0.0).norm(), 0.0, 1e-12);
  // An error of the readout time counts in proportion to the velocity.
  const Matrix6 expected = 1e-6 * velocity * velocity.transpose();
  EXPECT_NEAR((change.duringReadout(velocity, still, kReadout, 1e-3) - expected).norm(), 0.0, 1e-12);
  EXPECT_NEAR((change.duringReadout(velocity, 2.0 * velocity, kReadout, 1e-3) - expected).norm(), 0.0, 1e-12)
      << "the keyframe's image is bent twice as much, and the frame's once";
  EXPECT_NEAR(change.duringReadout(velocity, velocity, kReadout, 1e-3).norm(), 0.0, 1e-12)
      << "both are bent alike";
}

TEST(VelocityChange, CoversAVelocityThatWalksAtRandom) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  constexpr int kFine = 20;  // parts of a frame interval
  const Vector6 still = Vector6::Zero();
  double velocity = 0.0, squares = 0.0, variances = 0.0;
  VelocityChange change;
  for (int frame = 0; frame < 5000; ++frame) {
    double mean = 0.0;
    for (int part = 0; part < kFine; ++part) {
      velocity += normal(random) / std::sqrt(kFine);
      mean += velocity / kFine;
    }
    Vector6 twist = Vector6::Zero();
    twist.head<3>().setConstant(mean * kInterval);
    change.observe({twist, kInterval});
    if (frame < 50) continue;
    const double error = (velocity - mean) * kReadout;
    squares += error * error;
    variances += change.duringReadout(still, still, kReadout, 0.0)(0, 0);
  }
  // The variance has the frame's error, and half as much for the keyframe's error.
  EXPECT_NEAR(variances / squares, 1.5, 0.15);
}

TEST(VelocityChange, DoesNotSpanALoss) {
  VelocityChange change;
  const Vector6 fast = Vector6::Constant(0.1), still = Vector6::Zero();
  change.observe({fast, kInterval});
  change.observe(Step());
  change.observe({-fast, kInterval});
  EXPECT_EQ(change.duringReadout(still, still, kReadout, 0.0), Matrix6::Zero());
}

TEST(VelocityChange, AnUnknownVelocityMayBeAsFastAsTheCameraWasBefore) {
  VelocityChange change;
  Vector6 twist = Vector6::Zero();
  twist(1) = 0.02, twist(5) = -0.01;
  for (int i = 0; i < 5; ++i) change.observe({twist, kInterval});
  change.observe(Step());
  const Vector6 velocity = twist / kInterval;
  // Either image may be the one whose velocity is not known.
  for (const Matrix6& covariance : {change.duringReadout(std::nullopt, velocity, kReadout, 0.0),
                                    change.duringReadout(velocity, std::nullopt, kReadout, 0.0)}) {
    const double move = covariance.topLeftCorner<3, 3>().trace();
    const double turn = covariance.bottomRightCorner<3, 3>().trace();
    EXPECT_NEAR(move, std::pow(kReadout * velocity(1), 2), 1e-9);
    EXPECT_NEAR(turn, std::pow(kReadout * velocity(5), 2), 1e-9);
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
