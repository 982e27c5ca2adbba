// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/stereo_candidates.h"

#include <gtest/gtest.h>

namespace rgbd_sfm_fusion {
namespace {

class StereoCandidatesTest : public testing::Test {
 protected:
  StereoCandidatesTest() { image_(cv::Rect(20, 0, 30, 100)).setTo(160.0); }

  StereoCandidates collect(int bottom) const {
    StereoCandidates candidates;
    candidates.collect(image_, {0, 0, 90, bottom}, 5.0F);
    return candidates;
  }

  cv::Mat_<float> image_ = cv::Mat_<float>(120, 90, 100.0F);
};

/// All lanes of a block share one geometry. Padding must not be searched.
TEST_F(StereoCandidatesTest, ABlockIsOfItsBand) {
  for (int bottom = 30; bottom < 120; bottom += 7) {
    const StereoCandidates candidates = collect(bottom);
    for (std::size_t band = 0; band < candidates.bands().size(); ++band) {
      for (const StereoCandidates::Block& block : candidates.bands()[band]) {
        for (int lane = 0; lane < kLanes; ++lane) {
          const int row = block.pixel[lane] / 90;
          EXPECT_EQ(static_cast<float>(row), block.v[lane]);
          EXPECT_EQ(static_cast<std::size_t>(row / RowBands::kRows), band);
          const bool is_copy = lane > 0 && block.pixel[lane] == block.pixel[lane - 1];
          EXPECT_EQ(block.gradient_x[lane] == 0.0F && block.gradient_y[lane] == 0.0F, is_copy);
        }
      }
    }
  }
}

TEST(StereoCandidates, OfARampAreAllPixelsWithRoomForAPattern) {
  cv::Mat_<float> ramp(23, 37);
  for (int v = 0; v < ramp.rows; ++v) {
    for (int u = 0; u < ramp.cols; ++u)
      ramp(v, u) = 3.0F * static_cast<float>(u) - 2.0F * static_cast<float>(v);
  }
  const cv::Rect seen(2, 1, 30, 21);
  StereoCandidates candidates;
  candidates.collect(ramp, seen, 3.5F);
  ASSERT_EQ(candidates.bands().size(), 1U);
  std::vector<int> pixels;
  for (const StereoCandidates::Block& block : candidates.bands()[0]) {
    for (int lane = 0; lane < kLanes; ++lane) {
      if (!pixels.empty() && pixels.back() == block.pixel[lane]) continue;
      pixels.push_back(block.pixel[lane]);
      EXPECT_EQ(block.gradient_x[lane], 3.0F);
      EXPECT_EQ(block.gradient_y[lane], -2.0F);
    }
  }
  constexpr int kBorder = StereoCandidates::kBorder;
  std::vector<int> inside;
  for (int v = seen.y + kBorder; v < seen.br().y - kBorder; ++v) {
    for (int u = seen.x + kBorder; u < seen.br().x - kBorder; ++u) inside.push_back(v * ramp.cols + u);
  }
  EXPECT_EQ(pixels, inside);
  candidates.collect(ramp, seen, 3.7F);
  EXPECT_TRUE(candidates.bands()[0].empty());
}

TEST_F(StereoCandidatesTest, ThoseThatAreWantedAreCollectedInTheGivenBandsAlone) {
  const StereoCandidates all = collect(120);
  StereoCandidates some;
  some.collectFrom(all, {}, [](int pixel) { return pixel % 90 < 40; });
  some.collectFrom(all, {1, 2}, [](int) { return false; });
  ASSERT_EQ(some.bands().size(), 4U);
  EXPECT_TRUE(some.bands()[1].empty());
  ASSERT_FALSE(some.bands()[0].empty());
  for (const StereoCandidates::Block& block : some.bands()[0]) {
    for (const int pixel : block.pixel) EXPECT_LT(pixel % 90, 40);
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
