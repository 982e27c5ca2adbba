// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/reprojection.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace rgbd_sfm_fusion {
namespace {

constexpr int kWidth = 60, kHeight = 40, kEdge = 30;

GreyImage edge(int left, int right) {
  GreyImage grey(kHeight, kWidth, static_cast<std::uint8_t>(left));
  grey.colRange(kEdge, kWidth).setTo(right);
  return grey;
}

using Mask = cv::Mat_<std::uint8_t>;

ImagePool pool;
const Mask kNothing(kHeight, kWidth, std::uint8_t{0});

Mask shineThrough(const GreyImage& grey, const Mask& measured) {
  Mask marked(kHeight, kWidth, std::uint8_t{0});
  markShineThrough(grey, measured, pool, marked);
  return marked;
}

TEST(ShineThrough, DepthStaysBesideAnEdgeAndGoesWhereTheImageIsPlain) {
  const Mask marked = shineThrough(edge(20, 60), kNothing);
  for (int x = 0; x < kWidth; ++x) {
    const bool beside_edge = x >= kEdge - 2 && x < kEdge + 2;
    EXPECT_EQ(!beside_edge, marked(20, x) != 0) << "column " << x;
  }
}

TEST(ShineThrough, WhereTheSensorSeesNothingChanges) {
  Mask measured(kHeight, kWidth, std::uint8_t{0});
  measured.colRange(0, 10).setTo(1);
  const Mask marked = shineThrough(edge(20, 20), measured);
  for (int x = 0; x < kWidth; ++x) EXPECT_EQ(x >= 10, marked(20, x) != 0) << "column " << x;
}

TEST(ShineThrough, AFaintEdgeIsNoise) {
  EXPECT_EQ(kWidth * kHeight, cv::countNonZero(shineThrough(edge(20, 25), kNothing)));
  EXPECT_EQ((kWidth - 4) * kHeight, cv::countNonZero(shineThrough(edge(26, 20), kNothing)));
}

}  // namespace
}  // namespace rgbd_sfm_fusion
