// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/sensor/stray_depth.h"

#include <gtest/gtest.h>

#include "unit/fusion/depth_images.h"

namespace rgbd_sfm_fusion {
namespace {

using test::kNone;

/// @return how many depths are removed; checks that both ways to ask say the same
int strays(const DepthImage& measured, const DepthNoiseModel& noise = {}) {
  GaussianDepth depth = withNoise(measured, noise);
  const int before = cv::countNonZero(depth.mean > 0.0F);
  removeStrays(measured, noise, &depth);
  EXPECT_TRUE(test::isConsistent(depth));
  for (int y = 0; y < measured.rows; ++y) {
    for (int x = 0; x < measured.cols; ++x) {
      if (measured(y, x) > 0.0F) {
        EXPECT_EQ(depth.mean(y, x) > 0.0F, isSparse(measured) || !isStray(measured, {x, y}, noise))
            << x << ' ' << y;
      }
    }
  }
  return before - cv::countNonZero(depth.mean > 0.0F);
}

/// The same depth, as if registered to an image of `factor` times the size.
DepthImage enlarged(const DepthImage& depth, int factor) {
  DepthImage result(factor * depth.rows, factor * depth.cols, kNone);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) result(factor * y, factor * x) = depth(y, x);
  }
  return result;
}

TEST(StrayDepth, SurfacesStayUpToTheirRims) {
  DepthImage depth = test::plane(test::smallCamera(), {0.3, -0.2, 1.0}, 2.0);
  EXPECT_EQ(strays(depth), 0);
  depth(cv::Rect(40, 30, 60, 50)) -= 0.7F;
  depth(cv::Rect(110, 0, 2, 120)).setTo(0.9);  // a pole
  depth(cv::Rect(0, 90, 70, 20)).setTo(kNone);
  EXPECT_EQ(strays(depth), 0);
  for (const int factor : {2, 3, 4, 5}) {
    EXPECT_EQ(isSparse(enlarged(depth, factor)), factor > 3) << factor;
    EXPECT_EQ(strays(enlarged(depth, factor)), 0) << factor;
  }
  EXPECT_FALSE(isSparse(depth));
}

TEST(StrayDepth, ADepthByItselfIsOneAlsoWithMuchNoise) {
  DepthImage depth = test::constant({80, 60}, kNone);
  depth(cv::Rect(0, 0, 30, 60)).setTo(4.0);
  depth(30, 60) = 4.0F;
  DepthNoiseModel noise;
  noise.quadratic = 0.1F;
  EXPECT_EQ(strays(depth, noise), 1);
  depth.setTo(0.0, depth != depth);
  EXPECT_EQ(strays(depth, noise), 1) << "0 is none, too";
}

TEST(StrayDepth, NoiseOfFarDepthIsNoStray) {
  DepthImage depth = test::constant({80, 60}, 4.5F);
  DepthNoiseModel noise;
  noise.quadratic = 5e-3F;
  cv::Mat_<float> errors(depth.size());
  cv::RNG(3).fill(errors, cv::RNG::NORMAL, 0.0, 0.5 * static_cast<double>(noise.sigmaZ(4.5F)));
  depth += errors;
  EXPECT_LT(strays(depth, noise), 5);
}

TEST(StrayDepth, WildDepthAlongContoursAndInHolesGoes) {
  DepthImage depth = test::constant({160, 120}, 2.5F);
  cv::RNG random(1);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 70; x < 160; ++x) {
      const bool is_contour = x<74, is_speck = x> 80 && random.uniform(0.0, 1.0) < 0.05;
      depth(y, x) = is_contour || is_speck ? random.uniform(0.4F, 2.4F) : kNone;
    }
  }
  const int wild = cv::countNonZero(depth(cv::Rect(70, 0, 90, 120)) > 0.0F);
  ASSERT_GT(wild, 700);
  EXPECT_GT(strays(depth), 0.9 * wild);
  DepthNoiseModel paper;
  paper.lateral_sigma = 0.0F;
  EXPECT_EQ(strays(depth, paper), 0);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
