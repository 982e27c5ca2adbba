// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/sampling.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace rgbd_sfm_fusion {
namespace {

/// One position after the other, as vector code does it.
template <class Value>
float sampled(const cv::Mat_<Value>& image, float u, float v) {
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  const float a = u - static_cast<float>(x), b = v - static_cast<float>(y);
  const auto at = [&](int row, int column) { return static_cast<float>(image(row, column)); };
  const float top = at(y, x) + a * (at(y, x + 1) - at(y, x));
  const float bottom = at(y + 1, x) + a * (at(y + 1, x + 1) - at(y + 1, x));
  return top + b * (bottom - top);
}

TEST(Sampling, OfABlockHasTheBitsOfSingleSamples) {
  // Without a margin: a sanitizer sees what is read beyond the image.
  cv::Mat_<std::uint8_t> grey(20, 30);
  cv::RNG random(5);
  random.fill(grey, cv::RNG::UNIFORM, 0, 256);
  cv::Mat_<float> image;
  grey.convertTo(image, CV_32F);
  for (int round = 0; round < 100; ++round) {
    float u[kLanes], v[kLanes], of_grey[kLanes], of_floats[kLanes];
    for (int l = 0; l < kLanes; ++l) u[l] = random.uniform(0.0F, 29.0F), v[l] = random.uniform(0.0F, 19.0F);
    if (round == 0) u[0] = 0.0F, v[0] = 0.0F, u[1] = 28.99F, v[1] = 18.99F;
    sampleBlock(grey[0], grey.cols, u, v, of_grey);
    sampleBlock(image[0], image.cols, u, v, of_floats);
    for (int l = 0; l < kLanes; ++l) {
      EXPECT_EQ(of_grey[l], sampled(grey, u[l], v[l]));
      EXPECT_EQ(of_floats[l], sampled(image, u[l], v[l]));
    }
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
