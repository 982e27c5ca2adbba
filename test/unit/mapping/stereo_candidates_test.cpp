// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/stereo_candidates.h"

#include <gtest/gtest.h>

namespace rgbd_sfm_fusion {
namespace {

class StereoCandidatesTest : public testing::Test {
 protected:
  StereoCandidatesTest() {
    cv::Mat_<float> image(120, 90, 100.0F);
    image(cv::Rect(20, 0, 30, 100)).setTo(160.0);
    gradient_.compute(image);
  }

  StereoCandidates collect(int bottom) const {
    StereoCandidates candidates;
    candidates.collect(gradient_, {0, 0, 90, bottom}, 5.0F);
    return candidates;
  }

  ImageGradient gradient_;
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
