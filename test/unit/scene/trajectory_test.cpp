// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/scene/trajectory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace rgbd_sfm_fusion {
namespace {

constexpr std::uint64_t kSeeds[] = {0, 1, 2, 3, 42, 1ULL << 40, ~0ULL};
constexpr double kStep = 1e-3;  // [s]

Vector6 velocity(const HandheldTrajectory& trajectory, double time) {
  const SE3 before = trajectory.T_world_camera(time - 0.5 * kStep);
  return (before.inverse() * trajectory.T_world_camera(time + 0.5 * kStep)).log() / kStep;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

TEST(HandheldTrajectory, MovesAsFastAsHandsDo) {
  for (const std::uint64_t seed : kSeeds) {
    const HandheldTrajectory trajectory(seed);
    std::vector<double> speed, turn;  // [m/s], [deg/s]
    for (double t = 0.0; t < HandheldTrajectory::kPeriod; t += 0.01) {
      const Vector6 v = velocity(trajectory, t);
      speed.push_back(v.head<3>().norm());
      turn.push_back(v.tail<3>().norm() * 180.0 / M_PI);
    }
    EXPECT_LT(*std::max_element(speed.begin(), speed.end()), 0.7) << seed;
    EXPECT_LT(*std::max_element(turn.begin(), turn.end()), 45.0) << seed;
    EXPECT_GT(median(speed), 0.15) << seed;
    EXPECT_LT(median(speed), 0.4) << seed;
    EXPECT_LT(median(turn), 30.0) << seed;
  }
}

TEST(HandheldTrajectory, HasNoJerks) {
  for (const std::uint64_t seed : kSeeds) {
    const HandheldTrajectory trajectory(seed);
    for (double t = -1.0; t < HandheldTrajectory::kPeriod + 1.0; t += 0.01) {
      const Vector6 acceleration = (velocity(trajectory, t + kStep) - velocity(trajectory, t)) / kStep;
      EXPECT_LT(acceleration.head<3>().norm(), 6.0) << seed << ' ' << t;
      EXPECT_LT(acceleration.tail<3>().norm(), 4.0) << seed << ' ' << t;
    }
  }
}

TEST(HandheldTrajectory, ReturnsToWhereItStarted) {
  for (const std::uint64_t seed : kSeeds) {
    const HandheldTrajectory trajectory(seed);
    for (const double t : {0.0, 0.3, 7.0}) {
      const SE3 there = trajectory.T_world_camera(t);
      const SE3 later = trajectory.T_world_camera(t + 3 * HandheldTrajectory::kPeriod);
      EXPECT_LT((there.inverse() * later).log().norm(), 1e-9) << seed;
    }
  }
}

TEST(HandheldTrajectory, HasParallaxFromTheStart) {
  for (const std::uint64_t seed : kSeeds) {
    const HandheldTrajectory trajectory(seed);
    const SE3 motion = trajectory.T_world_camera(0.0).inverse() * trajectory.T_world_camera(0.3);
    EXPECT_GT(motion.translation().head<2>().norm(), 0.03) << seed;  // across the line of sight
  }
}

TEST(HandheldTrajectory, StaysUprightAndWithinTheFreePartOfTheRoom) {
  for (const std::uint64_t seed : kSeeds) {
    const HandheldTrajectory trajectory(seed);
    for (double t = 0.0; t < HandheldTrajectory::kPeriod; t += 0.05) {
      const SE3 T = trajectory.T_world_camera(t);
      EXPECT_NEAR(T.translation().x(), 2.0, 0.9) << seed << ' ' << t;
      EXPECT_NEAR(T.translation().y(), 1.6, 0.9) << seed << ' ' << t;
      EXPECT_NEAR(T.translation().z(), 1.4, 0.25) << seed << ' ' << t;
      EXPECT_LT((T.rotation() * Eigen::Vector3d::UnitY()).z(), -0.9) << seed << ' ' << t;  // down is down
    }
  }
}

TEST(HandheldTrajectory, DiffersBySeed) {
  const SE3 one = HandheldTrajectory(1).T_world_camera(3.0),
            other = HandheldTrajectory(2).T_world_camera(3.0);
  EXPECT_GT((one.inverse() * other).log().norm(), 1e-2);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
