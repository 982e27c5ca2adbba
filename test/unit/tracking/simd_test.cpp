// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/simd.h"

#include <gtest/gtest.h>

#include <cstring>
#include <opencv2/core.hpp>

namespace rgbd_sfm_fusion {
namespace {

TEST(Sampling, WholeGreyLevelsGiveTheSameBitsAsFloats) {
  cv::Mat_<std::uint8_t> grey(20, 30);
  cv::RNG random(5);
  random.fill(grey, cv::RNG::UNIFORM, 0, 256);
  cv::Mat_<float> image;
  grey.convertTo(image, CV_32F);
  for (int round = 0; round < 100; ++round) {
    float u[kLanes], v[kLanes], of_grey[kLanes], of_floats[kLanes];
    for (int l = 0; l < kLanes; ++l) u[l] = random.uniform(0.0F, 29.0F), v[l] = random.uniform(1.0F, 19.0F);
    if (round == 0) u[0] = 2.0F, v[0] = 0.0F, u[1] = 0.0F, v[1] = 1.0F;  // the first that may be asked for
    sampleGreyBlock()(grey[0], grey.cols, u, v, of_grey);
    sampleBlock()(image[0], image.cols, u, v, of_floats);
    EXPECT_EQ(std::memcmp(of_grey, of_floats, sizeof(of_grey)), 0);
    EXPECT_GE(of_grey[0], 0.0F);
    EXPECT_LE(of_grey[0], 255.0F);
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
