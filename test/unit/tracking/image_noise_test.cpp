// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/image_noise.h"

#include <gtest/gtest.h>

#include <limits>

namespace rgbd_sfm_fusion {
namespace {

double after(double expected, double of_frame) {
  ImageNoise noise(expected);
  noise.observe(of_frame);
  return noise.sigma();
}

TEST(ImageNoise, IsThatOfTheLastFrame) {
  EXPECT_DOUBLE_EQ(ImageNoise(4.0).sigma(), 4.0);
  EXPECT_DOUBLE_EQ(after(4.0, 1.7), 1.7);
}

TEST(ImageNoise, StaysWithinWhatACameraMayHave) {
  EXPECT_NEAR(after(4.0, 0.0), 0.289, 1e-3) << "rounding to whole grey levels";
  EXPECT_DOUBLE_EQ(after(4.0, 20.0), 4.0);
}

TEST(ImageNoise, AFrameThatDoesNotTellChangesNothing) {
  EXPECT_DOUBLE_EQ(after(4.0, std::numeric_limits<double>::quiet_NaN()), 4.0);
}

TEST(ImageNoise, IsMoreIfTheImageItselfHasMore) {
  ImageNoise noise(4.0);
  noise.look(9.0);
  noise.observe(20.0);
  EXPECT_DOUBLE_EQ(noise.sigma(), 9.0);
}

TEST(ImageNoise, OfTheImageIsNotMoreThanAlignmentLeaves) {
  ImageNoise noise(4.0);
  noise.look(9.0);
  EXPECT_DOUBLE_EQ(noise.ofImage(), 9.0) << "nothing was aligned yet";
  noise.look(3.0);
  noise.observe(1.5);
  EXPECT_DOUBLE_EQ(noise.ofImage(), 1.5) << "the rest is texture";
  noise.look(0.5);
  EXPECT_DOUBLE_EQ(noise.ofImage(), 0.5) << "the rest is what alignment cannot explain";
}

/// Rounding alone makes more noise than that.
TEST(ImageNoise, IsNeverAboveWhatIsExpected) {
  ImageNoise noise(0.1);
  for (const double of_frame : {0.05, 0.2, 3.0}) {
    noise.observe(of_frame);
    EXPECT_EQ(noise.sigma(), 0.1) << of_frame;
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
