// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/image/pixel_noise.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace rgbd_sfm_fusion {
namespace {

constexpr int kWidth = 320, kHeight = 240;
const cv::Rect kAll(0, 0, kWidth, kHeight);

/// A slope of brightness, with edges along rows and columns, and noise.
GreyImage image(double sigma) {
  cv::Mat_<float> noise(kHeight, kWidth);
  cv::RNG(3).fill(noise, cv::RNG::NORMAL, 0.0, sigma);
  GreyImage result(kHeight, kWidth);
  for (int v = 0; v < kHeight; ++v)
    for (int u = 0; u < kWidth; ++u)
      result(v, u) = cv::saturate_cast<std::uint8_t>(60.0F + 0.2F * static_cast<float>(u) +
                                                     (u / 40 % 2 == 0 ? 40.0F : 0.0F) + noise(v, u));
  return result;
}

TEST(PixelNoise, IsThatOfThePixels) {
  for (const double sigma : {1.0, 3.0, 10.0})
    EXPECT_NEAR(pixelNoise(image(sigma), kAll), sigma, 0.15 * sigma);
}

TEST(PixelNoise, IsNoneOfShapes) {
  EXPECT_LT(pixelNoise(image(0.0), kAll), 0.3);
}

TEST(PixelNoise, IsOfWhatTheCameraHasSeen) {
  GreyImage grey = image(0.0);
  const cv::Rect seen(0, kHeight / 2, kWidth, kHeight / 2);
  image(10.0)(seen).copyTo(grey(seen));
  EXPECT_NEAR(pixelNoise(grey, seen), 10.0, 1.5);
}

TEST(PixelNoise, IsNotThatOfWhatIsTooBright) {
  GreyImage grey = image(10.0);
  grey.rowRange(0, kHeight / 4).setTo(255);
  EXPECT_NEAR(pixelNoise(grey, kAll), 10.0, 1.5);
}

TEST(PixelNoise, IsZeroWithoutPixels) {
  EXPECT_EQ(pixelNoise(image(3.0), {0, 0, 2, 2}), 0.0);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
