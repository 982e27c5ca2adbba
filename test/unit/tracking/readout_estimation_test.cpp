// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/readout_estimation.h"

#include <gtest/gtest.h>

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
      estimator.observe(saying(time - aligned), aligned, kInterval);
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
      estimator.observe(saying(bias), estimator.readoutTime(), kInterval);
      ASSERT_EQ(estimator.readoutTime(), 0.0) << i << ", " << bias;
    }
    EXPECT_LT(estimator.sigma(), 0.001) << bias;
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
