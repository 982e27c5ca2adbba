// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/preview/colour_scale.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rgbd_sfm_fusion/preview/source_colours.h"

namespace rgbd_sfm_fusion {
namespace {

int brightness(const cv::Vec3b& rgb) {
  return rgb[0] + rgb[1] + rgb[2];
}

TEST(ColourScale, DepthIsTurboOverAFixedRange) {
  const ColourScale& scale = ColourScale::depth();
  EXPECT_EQ(scale.colour(0.4F), cv::Vec3b(48, 18, 59)) << "turbo's first colour";
  EXPECT_EQ(scale.colour(10.0F), cv::Vec3b(122, 4, 3)) << "turbo's last colour";
  EXPECT_EQ(scale.colour(0.1F), scale.colour(0.4F));
  EXPECT_EQ(scale.colour(50.0F), scale.colour(10.0F));
}

TEST(ColourScale, AStepOfTheSameRatioIsAStepOfTheSameColour) {
  const ColourScale& scale = ColourScale::standardDeviation();
  EXPECT_NEAR(scale.place(0.001), 0.0, 1e-12);
  EXPECT_NEAR(scale.place(0.01), 1.0 / 3.0, 1e-12);
  EXPECT_NEAR(scale.place(0.1), 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(scale.place(1.0), 1.0, 1e-12);
}

TEST(ColourScale, TheSurerTheBrighter) {
  int before = 766;
  for (const float sigma : {0.001F, 0.005F, 0.02F, 0.1F, 0.5F}) {
    const int now = brightness(ColourScale::standardDeviation().colour(sigma));
    EXPECT_LT(now, before) << sigma;
    before = now;
  }
}

TEST(ColourScale, NoDepthIsBlackAndNothingElseIs) {
  const cv::Vec3b black(0, 0, 0);
  for (const ColourScale* scale : {&ColourScale::depth(), &ColourScale::standardDeviation()}) {
    for (const float value : {NAN, 0.0F, -1.0F}) EXPECT_EQ(scale->colour(value), black);
    for (const float value : {1e-6F, 1.0F, 1e6F, INFINITY}) EXPECT_GT(brightness(scale->colour(value)), 60);
  }
}

TEST(SourceColours, AreThePapersAndBlueForCompleted) {
  const cv::Mat_<std::uint8_t> labels = (cv::Mat_<std::uint8_t>(1, 6) << 0, 1, 2, 3, 4, 9);
  const cv::Mat_<cv::Vec3b> painted = paintSources(labels);
  EXPECT_EQ(painted(0), cv::Vec3b(0, 0, 0));
  EXPECT_EQ(painted(1), cv::Vec3b(255, 255, 255));
  EXPECT_EQ(painted(2), cv::Vec3b(255, 255, 0));
  EXPECT_EQ(painted(3), cv::Vec3b(255, 0, 0));
  EXPECT_EQ(painted(4), cv::Vec3b(0, 0, 255));
  EXPECT_EQ(painted(5), cv::Vec3b(0, 0, 0)) << "a value that there is not";
}

}  // namespace
}  // namespace rgbd_sfm_fusion
