// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/scaled_depth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "unit/fusion/depth_images.h"

namespace rgbd_sfm_fusion {
namespace {

using test::kNone;

GaussianDepth image(const cv::Size& size, float mean, float variance) {
  return {DepthImage(size, mean), cv::Mat_<float>(size, variance)};
}

TEST(ScaledDepth, IsTheGaussianOfTheProductWithAnUncertainScale) {
  const GaussianDepth result = scaled(image({9, 2}, 2.0f, 0.01f), {1.5, 0.02, 4.0}, 0.2);
  EXPECT_FLOAT_EQ(result.mean(1, 3), 3.0f);
  EXPECT_FLOAT_EQ(result.variance(1, 3), 4.0f * 1.5f * 1.5f * 0.01f + 2.0f * 2.0f * 0.02f * 0.02f);
}

TEST(ScaledDepth, AnErrorOfInverseDepthGrowsWithTheSquareOfDepth) {
  const double sigma = 0.01;  // [1/m]
  for (const float units : {1.0f, 2.0f, 4.0f}) {
    const GaussianDepth result = scaled(image({9, 2}, units, 1e-9f), {1.5, 0.0, 1.0, sigma}, 0.2);
    const double z = 1.5 * static_cast<double>(units);
    EXPECT_NEAR(std::sqrt(static_cast<double>(result.variance(1, 3))), sigma * z * z, 1e-3 * sigma * z * z);
  }
}

TEST(ScaledDepth, DropsWhatIsNoGaussianInDepth) {
  GaussianDepth sfm = image({20, 1}, 2.0f, 0.01f);
  const float inf = std::numeric_limits<float>::infinity();
  const float bad_variances[] = {0.161f, inf, kNone, 0.0f, -1.0f};
  for (int i = 0; i < 5; ++i) sfm.variance(0, i) = bad_variances[i];
  const float bad_means[] = {0.0f, -2.0f, kNone, inf};
  for (int i = 0; i < 4; ++i) sfm.mean(0, 5 + i) = bad_means[i];
  sfm.variance(0, 9) = 0.159f;
  const GaussianDepth result = scaled(sfm, {1.5, 0.0, 1.0}, 0.2);
  EXPECT_TRUE(test::isConsistent(result));
  for (int i = 0; i < 20; ++i) EXPECT_EQ(std::isnan(result.mean(0, i)), i < 9) << i;
}

}  // namespace
}  // namespace rgbd_sfm_fusion
