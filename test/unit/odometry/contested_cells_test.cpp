// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/contested_cells.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rgbd_sfm_fusion {
namespace {

constexpr float kSigma = 0.02F;  // [1/m] of a pixel: ten times the difference that a square's mean may have
constexpr double kWideParallax = 0.15, kNarrowParallax = 0.005;
const cv::Rect kBox(96, 64, 96, 64);  // 3 x 2 squares

InverseDepthImage measured(double noise, std::uint64_t seed) {
  InverseDepthImage depth;
  depth.create({320, 240});
  cv::RNG(seed).fill(depth.mean, cv::RNG::NORMAL, 0.5, noise);
  depth.variance.setTo(static_cast<double>(kSigma * kSigma));
  return depth;
}

class ContestedCellsTest : public testing::Test {
 protected:
  InverseDepthImage sensor_ = measured(static_cast<double>(kSigma), 1),
                    stereo_ = measured(static_cast<double>(kSigma), 2);
};

TEST_F(ContestedCellsTest, AreNoneWhereOnlyNoiseDiffers) {
  EXPECT_TRUE(ContestedCells().find(sensor_, stereo_, kWideParallax).empty());
}

TEST_F(ContestedCellsTest, AreThoseWhereTheSensorIsATenthOff) {
  sensor_.mean(kBox) /= 1.1;
  const auto cells = ContestedCells().find(sensor_, stereo_, kWideParallax);
  EXPECT_EQ(cells.size(), 6U);
  for (const cv::Rect& cell : cells) EXPECT_EQ(cell & kBox, cell);
}

/// 240 rows are seven squares and a half.
TEST_F(ContestedCellsTest, AreAlsoThePartsOfSquaresAtTheBorder) {
  const cv::Rect lowest(0, 224, 64, 16);
  sensor_.mean(lowest) /= 1.1;
  const auto cells = ContestedCells().find(sensor_, stereo_, kWideParallax);
  ASSERT_EQ(cells.size(), 2U);
  for (const cv::Rect& cell : cells) EXPECT_EQ(cell & lowest, cell);
}

TEST_F(ContestedCellsTest, AreNoneWhenTheParallaxIsTooSmallToTell) {
  sensor_.mean(kBox) /= 1.1;
  EXPECT_TRUE(ContestedCells().find(sensor_, stereo_, kNarrowParallax).empty());
  EXPECT_TRUE(ContestedCells().find(sensor_, stereo_, 0.0).empty());
}

TEST_F(ContestedCellsTest, AreNoneWhenAllDifferAlike) {
  sensor_.mean *= 1.05;  // an error of scale
  EXPECT_TRUE(ContestedCells().find(sensor_, stereo_, kWideParallax).empty());
}

TEST_F(ContestedCellsTest, NeedEnoughPixelsWithBothDepths) {
  sensor_.mean(kBox) /= 1.1;
  for (int v = kBox.y; v < kBox.br().y; ++v) {
    for (int u = kBox.x; u < kBox.br().x; ++u) {
      if (v % 16 == 0 && u % 16 == 0) continue;  // four pixels of a square stay
      stereo_.mean(v, u) = 0.0F;
      stereo_.variance(v, u) = std::numeric_limits<float>::infinity();
    }
  }
  EXPECT_TRUE(ContestedCells().find(sensor_, stereo_, kWideParallax).empty());
}

TEST_F(ContestedCellsTest, FewWildPixelsMakeNone) {
  for (int i = 0; i < 240 * 320; i += 29) sensor_.mean(i / 320, i % 320) *= 4.0F;
  EXPECT_TRUE(ContestedCells().find(sensor_, stereo_, kWideParallax).empty());
}

}  // namespace
}  // namespace rgbd_sfm_fusion
