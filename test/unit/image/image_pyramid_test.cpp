// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/image/image_pyramid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace rgbd_sfm_fusion {
namespace {

GreyImage noise(int width, int height) {
  GreyImage image(height, width);
  cv::RNG(7).fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

TEST(ImagePyramid, GradientsOfNoiseAreAsLargeAsExpected) {
  ImagePyramid pyramid;
  GreyImage image(960, 1280);
  cv::RNG(5).fill(image, cv::RNG::NORMAL, 128.0, 20.0);
  pyramid.build(image, 4);
  for (int level = 0; level < 4; ++level) {
    const cv::Mat_<float>& pixels = pyramid[level];
    const int width = pixels.cols - 8;  // without what is repeated beyond the border
    cv::Mat differences = (pixels.colRange(5, 5 + width) - pixels.colRange(3, 3 + width)) / 2.0;
    cv::Scalar mean, sigma;
    cv::meanStdDev(differences, mean, sigma);
    EXPECT_NEAR(sigma[0], 20.0 * gradientOfNoise(level), 0.06 * sigma[0]) << level;
  }
}

TEST(ImagePyramid, EachPixelIsAWeightedMeanOfSixteen) {
  constexpr double kWeights[] = {1.0, 3.0, 3.0, 1.0};
  for (const cv::Size size : {cv::Size(64, 48), cv::Size(65, 51), cv::Size(7, 4)}) {
    ImagePyramid pyramid;
    pyramid.build(noise(size.width, size.height), 3);
    for (int level = 1; level < 3; ++level) {
      const cv::Mat_<float>&fine = pyramid[level - 1], &coarse = pyramid[level];
      ASSERT_EQ(coarse.size(), cv::Size(fine.cols / 2, fine.rows / 2));
      for (int v = 0; v < coarse.rows; ++v) {
        for (int u = 0; u < coarse.cols; ++u) {
          double sum = 0.0;
          for (int y = 0; y < 4; ++y) {
            for (int x = 0; x < 4; ++x) {
              const int row = std::clamp(2 * v - 1 + y, 0, fine.rows - 1);
              const int column = std::clamp(2 * u - 1 + x, 0, fine.cols - 1);
              sum += kWeights[y] * kWeights[x] * static_cast<double>(fine(row, column)) / 64.0;
            }
          }
          EXPECT_NEAR(static_cast<double>(coarse(v, u)), sum, 1e-3);
        }
      }
    }
  }
}

TEST(ImagePyramid, WhatIsTooFineForACoarseImageHardlyShowsInIt) {
  GreyImage stripes(64, 64);
  for (int v = 0; v < stripes.rows; ++v) {
    for (int u = 0; u < stripes.cols; ++u)
      stripes(v, u) = static_cast<std::uint8_t>(std::lround(128.0 + 100.0 * std::sin(2.0 * M_PI * u / 2.5)));
  }
  ImagePyramid pyramid;
  pyramid.build(stripes, 2);
  double least = 0.0, largest = 0.0;
  cv::minMaxLoc(pyramid[1].colRange(1, 31), &least, &largest);
  EXPECT_LT(largest - least, 10.0);  // of 200
}

TEST(ImagePyramid, APixelIsSeenIfAllThatItIsMadeOfIs) {
  ImagePyramid pyramid;
  pyramid.build(noise(65, 51), 3);
  EXPECT_EQ(pyramid.seen(2), cv::Rect(0, 0, 16, 12));
  const cv::Rect seen(5, 8, 41, 33);
  pyramid.build(noise(65, 51), 3, seen);
  EXPECT_EQ(pyramid.seen(0), seen);
  EXPECT_EQ(pyramid.seen(1), cv::Rect(3, 5, 19, 15));
  EXPECT_EQ(pyramid.seen(2), cv::Rect(2, 3, 8, 6));
}

TEST(CameraPyramid, RaysOfCoarsePixelsPassBetweenTheFineOnes) {
  const PinholeCamera camera{640, 480, 525.0, 520.0, 319.5, 239.25};
  const std::vector<PinholeCamera> cameras = cameraPyramid(camera, 4);
  ASSERT_EQ(cameras.size(), 4U);
  for (std::size_t level = 1; level < cameras.size(); ++level) {
    const Eigen::Vector3d ray = cameras[level].backProject(10.0, 20.0, 1.0);
    EXPECT_LT((cameras[level - 1].project(ray) - Eigen::Vector2d(20.5, 40.5)).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
