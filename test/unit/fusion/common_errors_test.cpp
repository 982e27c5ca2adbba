// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/common_errors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "unit/fusion/depth_images.h"

namespace rgbd_sfm_fusion {
namespace {

using test::kNone;

constexpr float kRho = 0.5f, kSigma = 0.002f;  // [1/m]
constexpr float kError = 0.01f;                // [1/m] of SfM's

class CommonErrors : public testing::Test {
 protected:
  CommonErrors() : used_(size_, static_cast<std::uint8_t>(Provenance::kFused)) {}

  rgbd_sfm_fusion::CommonErrors find() const { return commonErrors(sensor_, sfm_, used_); }

  cv::Size size_{42, 31};  // no multiples of a cell
  GaussianDepth sensor_{DepthImage(size_, 1.0f / kRho),
                        cv::Mat_<float>(size_, std::pow(kSigma / (kRho * kRho), 2.0f))};
  DepthImage sfm_{size_, 1.0f / (kRho + kError)};
  cv::Mat_<std::uint8_t> used_;
};

TEST_F(CommonErrors, AreMeansOverNeighbours) {
  const auto errors = find();
  ASSERT_EQ(errors.difference.size(), cv::Size(11, 8));
  for (const float difference : errors.difference) EXPECT_NEAR(difference, kError, 1e-6f);
  const float per_pixel = 9.0f * kSigma * kSigma;
  // By weight: 16 pixels of the cell, half of 4 times as many beside it, a quarter of as many at its corners.
  EXPECT_NEAR(errors.noise_variance(3, 5) / per_pixel, 1.0f / (16.0f + 32.0f + 16.0f), 1e-5f);
  EXPECT_NEAR(errors.noise_variance(0, 0) / per_pixel, 1.0f / (16.0f + 16.0f + 4.0f), 1e-5f);
}

TEST_F(CommonErrors, OnlyFusedPixelsCount) {
  for (int y = 0; y < size_.height; ++y) {
    for (int x = 0; x < size_.width; ++x) {
      if ((x + y) % 4 == 0) continue;
      used_(y, x) = static_cast<std::uint8_t>(Provenance::kSensor);
      sfm_(y, x) = x % 2 == 0 ? kNone : 17.0f;
      if (x % 3 == 0) sensor_.mean(y, x) = sensor_.variance(y, x) = kNone;
    }
  }
  const auto errors = find();
  for (const float difference : errors.difference) EXPECT_NEAR(difference, kError, 1e-6f);
  EXPECT_NEAR(errors.noise_variance(3, 5) / (9.0f * kSigma * kSigma), 1.0f / 16.0f, 1e-5f);
}

TEST_F(CommonErrors, AreThoseAroundOnly) {
  used_.colRange(20, size_.width).setTo(0.0);
  sfm_.colRange(0, 4).setTo(1.0 / static_cast<double>(kRho - kError));
  const auto errors = find();
  EXPECT_NEAR(errors.difference(3, 0), (-kError + 0.5f * kError) / 1.5f, 1e-6f);
  EXPECT_NEAR(errors.difference(3, 1), (-0.5f * kError + 1.5f * kError) / 2.0f, 1e-6f);
  EXPECT_NEAR(errors.difference(3, 2), kError, 1e-6f);
  EXPECT_EQ(errors.difference(3, 6), 0.0f);
  EXPECT_TRUE(std::isinf(errors.noise_variance(3, 6)));
}

}  // namespace
}  // namespace rgbd_sfm_fusion
