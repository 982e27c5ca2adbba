// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/reprojection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

namespace rgbd_sfm_fusion {
namespace {

constexpr int kWidth = 60, kHeight = 40, kEdge = 30;

GreyImage edge(int left, int right) {
  GreyImage grey(kHeight, kWidth, static_cast<std::uint8_t>(left));
  grey.colRange(kEdge, kWidth).setTo(right);
  return grey;
}

GaussianDepth depthEverywhere() {
  const cv::Size size(kWidth, kHeight);
  return {DepthImage(size, 2.0F), cv::Mat_<float>(size, 1e-4F)};
}

ImagePool pool;
const DepthImage kNothing(kHeight, kWidth, kNoDepth);

bool isEmpty(const GaussianDepth& depth, int x) {
  return std::isnan(depth.mean(20, x)) && std::isnan(depth.variance(20, x));
}

TEST(ShineThrough, DepthStaysBesideAnEdgeAndGoesWhereTheImageIsPlain) {
  GaussianDepth sfm = depthEverywhere();
  dropShineThrough(edge(20, 60), kNothing, sfm, pool);
  for (int x = 0; x < kWidth; ++x) {
    const bool beside_edge = x >= kEdge - 2 && x < kEdge + 2;
    EXPECT_EQ(!beside_edge, isEmpty(sfm, x)) << "column " << x;
    if (beside_edge) {
      EXPECT_EQ(2.0F, sfm.mean(20, x));
    }
  }
}

TEST(ShineThrough, WhereTheSensorSeesNothingChanges) {
  GaussianDepth sfm = depthEverywhere();
  DepthImage sensor = kNothing.clone();
  sensor.colRange(0, 10).setTo(1.5F);
  dropShineThrough(edge(20, 20), sensor, sfm, pool);
  for (int x = 0; x < kWidth; ++x) EXPECT_EQ(x >= 10, isEmpty(sfm, x)) << "column " << x;
}

TEST(ShineThrough, AFaintEdgeIsNoise) {
  GaussianDepth sfm = depthEverywhere();
  dropShineThrough(edge(20, 25), kNothing, sfm, pool);
  EXPECT_EQ(0, cv::countNonZero(sfm.mean == sfm.mean));
  sfm = depthEverywhere();
  dropShineThrough(edge(26, 20), kNothing, sfm, pool);
  EXPECT_EQ(4 * kHeight, cv::countNonZero(sfm.mean == sfm.mean));
}

}  // namespace
}  // namespace rgbd_sfm_fusion
