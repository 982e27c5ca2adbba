// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/image/image_border.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace rgbd_sfm_fusion {
namespace {

constexpr int kWidth = 320, kHeight = 240;
const cv::Rect kAll(0, 0, kWidth, kHeight);

GreyImage texture() {
  GreyImage image(kHeight, kWidth);
  cv::RNG(3).fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

TEST(InsideBorder, IsAllOfAnImageWithoutOne) {
  EXPECT_EQ(insideBorder(texture(), kAll), kAll);
  const cv::Rect part(10, 20, 200, 100);
  EXPECT_EQ(insideBorder(texture(), part), part);
}

TEST(InsideBorder, LeavesOutBarsAndFramesWithTheirEdge) {
  GreyImage bars = texture();
  bars.rowRange(0, 30).setTo(16);
  bars.rowRange(kHeight - 30, kHeight).setTo(16);
  EXPECT_EQ(insideBorder(bars, kAll), cv::Rect(0, 38, kWidth, kHeight - 76));
  GreyImage frame(kHeight, kWidth, std::uint8_t{255});
  const cv::Rect inside(6, 5, kWidth - 13, kHeight - 10);
  texture()(inside).copyTo(frame(inside));
  EXPECT_EQ(insideBorder(frame, kAll), cv::Rect(14, 13, kWidth - 29, kHeight - 26));
}

TEST(InsideBorder, OfCompressionIsEvenAllTheSame) {
  GreyImage bar = texture();
  cv::RNG(4).fill(bar.colRange(0, 20), cv::RNG::UNIFORM, 0, 9);
  EXPECT_EQ(insideBorder(bar, kAll), cv::Rect(28, 0, kWidth - 28, kHeight));
}

/// Nothing is known of where the scene begins: an image in the dark, or of a wall.
TEST(InsideBorder, IsNotMostOfAnImage) {
  GreyImage image(kHeight, kWidth, std::uint8_t{0});
  EXPECT_EQ(insideBorder(image, kAll), kAll);
  texture()(cv::Rect(150, 100, 20, 20)).copyTo(image(cv::Rect(150, 100, 20, 20)));
  EXPECT_EQ(insideBorder(image, kAll), kAll);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
