// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/shutter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rgbd_sfm_fusion {
namespace {

constexpr double kInterval = 1.0 / 30.0;  // [s]
constexpr double kReadout = 0.028;        // [s]

/// A frame that was aligned with a readout time, and whose residuals tell the right one.
CalibrationEquations equations(double aligned_time) {
  CalibrationEquations equations;
  equations.H.setIdentity();
  constexpr int kTime = CalibrationEquations::kReadout;
  equations.H(kTime, kTime) = 1e6;
  equations.g(kTime) = 1e6 * (kReadout - aligned_time) / kInterval;
  return equations;
}

/// What a turn during the readout makes of a pose whose error is all of that turn.
AlignmentResult bentByTheReadout() {
  AlignmentResult aligned;
  aligned.by_readout.setIdentity();
  return aligned;
}

/// Twist of a step about the frame's vertical axis.
Vector6 turn() {
  Vector6 twist = Vector6::Zero();
  twist(4) = 0.02;
  return twist;
}

/// Sigma of the turn about the frame's vertical axis, of a frame that turns relative to its keyframe.
double sigmaOfTurn(const Shutter& shutter, double aligned_time) {
  const Step still{Vector6::Zero(), kInterval};
  return std::sqrt(shutter.covariance(bentByTheReadout(), {turn(), kInterval}, aligned_time, still)(4, 4));
}

TEST(Shutter, KnowsHowFarOffAPoseIsThatWasAlignedBeforeTheReadoutTimeWasKnown) {
  OdometryOptions options;
  options.estimate_readout = true;
  options.readout_time = 0.0F;
  Shutter shutter(options);
  for (int i = 0; i < 3; ++i) shutter.observe({turn(), kInterval});
  const double speed = turn()(4) / kInterval;
  EXPECT_GT(sigmaOfTurn(shutter, 0.0), 0.4 * speed * kReadout) << "nothing is known yet";

  for (int i = 0; i < 30; ++i) shutter.observe(equations(0.0), i, 0.0, kInterval);
  ASSERT_NEAR(shutter.readoutTime(), kReadout, 1e-3);
  EXPECT_LT(sigmaOfTurn(shutter, kReadout), 0.1 * speed * kReadout);
  // What was learned meanwhile does not mend a pose that was aligned without it.
  EXPECT_NEAR(sigmaOfTurn(shutter, 0.0), speed * kReadout, 0.1 * speed * kReadout);

  // After a loss, the camera may turn as fast as before, or not at all. Turns are about any axis.
  const Matrix6 after_a_loss = shutter.covariance(bentByTheReadout(), Step(), kReadout, {turn(), kInterval});
  const double turns = after_a_loss.bottomRightCorner(3, 3).trace();
  EXPECT_NEAR(std::sqrt(turns), speed * kReadout, 0.1 * speed * kReadout);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
