// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/camera/default_intrinsics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rgbd_sfm_fusion {
namespace {

TEST(DefaultIntrinsics, SeesTheFieldOfView) {
  for (const double fov : {0.2, 1.02, 2.5}) {
    for (const int width : {160, 640, 1280}) {
      const PinholeCamera camera = defaultIntrinsics(width, width * 3 / 4, fov);
      const auto left = camera.backProject(-0.5, camera.cy, 1.0);
      const auto right = camera.backProject(width - 0.5, camera.cy, 1.0);
      EXPECT_NEAR(std::atan(right.x()) - std::atan(left.x()), fov, 1e-9);
      EXPECT_NEAR(std::atan(right.x()) + std::atan(left.x()), 0.0, 1e-9);
      EXPECT_EQ(camera.cy, 0.5 * camera.height - 0.5);
    }
  }
}

TEST(DefaultIntrinsics, OfAFiveToFourModeAreThoseOfItsFourToThreePart) {
  PinholeCamera expected = defaultIntrinsics(1280, 960, 1.0);
  expected.height = 1024;
  EXPECT_EQ(defaultIntrinsics(1280, 1024, 1.0), expected);
}

TEST(DefaultIntrinsics, DoWithoutASensibleFieldOfView) {
  for (const double fov : {0.0, -1.0, 60.0, 3.2, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_NEAR(defaultIntrinsics(640, 480, fov).fx, 320.0 * std::sqrt(3.0), 1e-9) << fov;
}

}  // namespace
}  // namespace rgbd_sfm_fusion
