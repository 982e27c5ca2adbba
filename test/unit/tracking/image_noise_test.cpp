// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/image_noise.h"

#include <gtest/gtest.h>

#include <limits>

namespace rgbd_sfm_fusion {
namespace {

double learned(double expected, double of_frames) {
  ImageNoise noise(expected);
  for (int frame = 0; frame < 100; ++frame) noise.observe(of_frames);
  return noise.sigma();
}

TEST(ImageNoise, ComesToWhatFramesSay) {
  EXPECT_DOUBLE_EQ(ImageNoise(4.0).sigma(), 4.0);
  EXPECT_NEAR(learned(4.0, 1.7), 1.7, 1e-3);
}

TEST(ImageNoise, StaysWithinWhatACameraMayHave) {
  EXPECT_NEAR(learned(4.0, 0.0), 1.0, 1e-3);
  EXPECT_NEAR(learned(4.0, 20.0), 4.0, 1e-3);
}

TEST(ImageNoise, OneFrameChangesLittle) {
  ImageNoise noise(4.0);
  noise.observe(1.0);
  EXPECT_GT(noise.sigma(), 3.0);
  const double before = noise.sigma();
  noise.observe(std::numeric_limits<double>::quiet_NaN());
  EXPECT_DOUBLE_EQ(noise.sigma(), before);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
