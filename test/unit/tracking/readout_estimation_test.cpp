// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/readout_estimation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rgbd_sfm_fusion {
namespace {

constexpr double kInterval = 1.0 / 30.0;  // [s]

/// Equations of a frame whose images say that the readout took longer than was assumed.
/// @param deviation  [s] by so much
CalibrationEquations saying(double deviation) {
  constexpr double kSigma = 1e-4;  // [s]
  CalibrationEquations equations;
  equations.H.setIdentity();
  equations.H(CalibrationEquations::kReadout, CalibrationEquations::kReadout) =
      kInterval * kInterval / (kSigma * kSigma);
  equations.g(CalibrationEquations::kReadout) =
      equations.H(CalibrationEquations::kReadout, CalibrationEquations::kReadout) * deviation / kInterval;
  return equations;
}

TEST(ReadoutEstimator, LearnsATimeOfEitherSign) {
  for (const double time : {0.02, -0.02}) {
    ReadoutEstimator estimator;
    for (int i = 0; i < 100; ++i) {
      const double aligned = estimator.readoutTime();
      estimator.observe(saying(time - aligned), i, Vector6::Zero(), aligned, kInterval);
    }
    EXPECT_NEAR(estimator.readoutTime(), time, 1e-3);
    EXPECT_LT(estimator.sigma(), 0.002) << time;
  }
}

/// Frames are aligned with a time of 0 as long as that is reported, and what they say does not add up.
TEST(ReadoutEstimator, ASmallBiasIsNoRollingShutter) {
  for (const double bias : {0.0003, -0.0003}) {
    ReadoutEstimator estimator;
    for (int i = 0; i < 2000; ++i) {
      estimator.observe(saying(bias), i, Vector6::Zero(), estimator.readoutTime(), kInterval);
      ASSERT_EQ(estimator.readoutTime(), 0.0) << i << ", " << bias;
    }
    EXPECT_LT(estimator.sigma(), 0.001) << bias;
  }
}

/// sigma() after ten frames that say much.
/// @param keyframes  that these frames belong to
double sigmaAfterTenFrames(int keyframes) {
  constexpr double kTime = 0.02;
  ReadoutEstimator estimator;
  for (int i = 0; i < 10; ++i) {
    const double aligned = estimator.readoutTime();
    CalibrationEquations equations = saying(kTime - aligned);
    // Two strips, one below the other, that contradict each other.
    for (const double sign : {1.0, -1.0}) {
      CalibrationEquations::Part& strip = equations.strips[sign > 0.0 ? 0 : 12];
      constexpr int kReadout = CalibrationEquations::kReadout;
      strip.H(kReadout, kReadout) = 0.5 * equations.H(kReadout, kReadout);
      strip.g(kReadout) = 0.5 * equations.g(kReadout) + sign * 100.0 * std::sqrt(strip.H(kReadout, kReadout));
    }
    estimator.observe(equations, i * keyframes / 10, Vector6::Zero(), aligned, kInterval);
  }
  EXPECT_NEAR(estimator.readoutTime(), kTime, 0.01);
  return estimator.sigma();
}

TEST(ReadoutEstimator, FramesOfOneKeyframeShareTheErrorsOfItsImage) {
  EXPECT_NEAR(sigmaAfterTenFrames(1) / sigmaAfterTenFrames(10), std::sqrt(10.0), 0.5);
}

/// A camera whose velocity changes by chance, seen by images without noise: what bends them besides the
/// readout time is the difference between the velocity during the readout and that on the way to the image.
TEST(ReadoutEstimator, AVelocityThatChangesIsAnHonestUncertainty) {
  constexpr double kTime = 0.025, kSpeed = 1.0, kChange = 0.4;  // [s], [1/s]
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  double squares = 0.0, sigmas = 0.0;
  constexpr int kRuns = 200;
  for (int run = 0; run < kRuns; ++run) {
    ReadoutEstimator estimator(0.02);
    for (int i = 0; i < 20; ++i) {
      // One strip at the upper edge of the image, another at the lower one. They see a turn, a velocity that
      // is off, and a readout time that is off.
      CalibrationEquations equations;
      const double aligned = estimator.readoutTime();
      const double off = kChange * normal(random);
      equations.H.diagonal().setConstant(1e-3);
      constexpr double kInformation = 1e9;
      for (const double share : {-0.5, 0.5}) {
        CalibrationEquations::Part& strip = equations.strips[share < 0.0 ? 0 : 12];
        CalibrationEquations::Vector J = CalibrationEquations::Vector::Zero();
        J(4) = 1.0;
        J(CalibrationEquations::kReadout) = share * kSpeed * kInterval;
        strip.H = kInformation * J * J.transpose();
        strip.g = kInformation * J * (share * (kSpeed * (kTime - aligned) + off * kTime));
        strip.share = share;
        equations.H += strip.H;
        equations.g += strip.g;
      }
      Vector6 variances = Vector6::Zero();
      variances(4) = kChange * kChange;
      estimator.observe(equations, i, variances, aligned, kInterval);
    }
    squares += std::pow(estimator.readoutTime() - kTime, 2) / kRuns;
    sigmas += std::pow(estimator.sigma(), 2) / kRuns;
  }
  EXPECT_GT(squares / sigmas, 0.5) << std::sqrt(squares) << " s of " << std::sqrt(sigmas);
  EXPECT_LT(squares / sigmas, 1.5) << std::sqrt(squares) << " s of " << std::sqrt(sigmas);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
