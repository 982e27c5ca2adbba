// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/reflections.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rgbd_sfm_fusion {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kMaxRange = 5.0F;
const cv::Rect kHole(200, 100, 160, 200);

/// A slanted wall at about 2.5 m: its inverse depth is affine in the pixel.
float wall(int x, int y) {
  return 1.0F / (0.4F + 2e-4F * static_cast<float>(x - 320) + 1e-4F * static_cast<float>(y - 240));
}

class Reflections : public testing::Test {
 protected:
  Reflections() {
    for (int y = 0; y < sensor_.rows; ++y) {
      for (int x = 0; x < sensor_.cols; ++x) sensor_(y, x) = wall(x, y);
    }
    sensor_(kHole).setTo(kNaN);
    sfm_.mean.setTo(kNaN);
    sfm_.variance.setTo(kNaN);
  }

  /// SfM depth of the hole: that of the wall times a factor.
  void seeInHole(float factor) {
    for (int y = kHole.y; y < kHole.br().y; ++y) {
      for (int x = kHole.x; x < kHole.br().x; ++x) {
        sfm_.mean(y, x) = factor * wall(x, y);
        sfm_.variance(y, x) = 1e-4F;
      }
    }
  }

  int removed() {
    const int before = cv::countNonZero(sfm_.mean == sfm_.mean);
    removeReflections(sensor_, kMaxRange, sfm_);
    EXPECT_EQ(cv::countNonZero(sfm_.mean == sfm_.mean), cv::countNonZero(sfm_.variance == sfm_.variance));
    return before - cv::countNonZero(sfm_.mean == sfm_.mean);
  }

  DepthImage sensor_ = DepthImage(480, 640);
  GaussianDepth sfm_{DepthImage(480, 640), DepthImage(480, 640)};
};

TEST_F(Reflections, WhatAMirrorOnAWallShowsIsRemoved) {
  seeInHole(1.6F);
  EXPECT_EQ(removed(), kHole.area());
}

TEST_F(Reflections, WhatLiesInTheWallOrBeforeItStays) {
  for (const float factor : {0.5F, 0.9F, 1.0F, 1.1F}) {
    seeInHole(factor);
    EXPECT_EQ(removed(), 0) << factor;
  }
}

TEST_F(Reflections, WhatAMirrorShowsBeyondTheRangeGoesToo) {
  seeInHole(1.6F);
  for (int x = kHole.x; x < kHole.br().x; ++x) sfm_.mean(150, x) = 6.0F;
  EXPECT_EQ(removed(), kHole.area());
}

TEST_F(Reflections, WhatADoorwayShowsBeyondTheRangeStays) {
  seeInHole(2.4F);
  EXPECT_EQ(removed(), 0);
}

TEST_F(Reflections, WhatAnOpeningShowsWhoseRimIsNotFlatStays) {
  // Below the hole there is no wall, but a floor that leads through it.
  for (int y = kHole.br().y; y < sensor_.rows; ++y) {
    for (int x = kHole.x; x < kHole.br().x; ++x) sensor_(y, x) = wall(x, y) * 1.3F;
  }
  seeInHole(1.6F);
  EXPECT_EQ(removed(), 0);
}

TEST_F(Reflections, AHoleThatTheImageCutsOffIsLeftAlone) {
  sensor_(cv::Rect(kHole.x, 0, kHole.width, kHole.y)).setTo(kNaN);
  seeInHole(1.6F);
  EXPECT_EQ(removed(), 0);
}

TEST_F(Reflections, WithoutSensorDepthNothingIsRemoved) {
  sensor_.setTo(kNaN);
  seeInHole(1.6F);
  EXPECT_EQ(removed(), 0);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
