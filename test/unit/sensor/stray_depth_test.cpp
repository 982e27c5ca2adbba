// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/sensor/stray_depth.h"

#include <gtest/gtest.h>

#include "unit/fusion/depth_images.h"

namespace rgbd_sfm_fusion {
namespace {

using test::kNone;

struct Strays {
  int all = 0, credible = 0;
};

Strays strays(const DepthImage& measured, const DepthNoiseModel& noise = {}) {
  const SortedDepth sorted = sortStrays(measured, noise);
  const GaussianDepth with_noise = withNoise(sorted, noise);
  EXPECT_TRUE(test::isConsistent(with_noise));
  Strays strays;
  for (int y = 0; y < measured.rows; ++y) {
    for (int x = 0; x < measured.cols; ++x) {
      const float z = measured(y, x), credible = sorted.credible(y, x), confirmed = sorted.confirmed(y, x);
      EXPECT_TRUE(credible > 0.0F ? credible == z : !(confirmed > 0.0F)) << x << ' ' << y;
      EXPECT_TRUE(!(confirmed > 0.0F) || confirmed == z) << x << ' ' << y;
      EXPECT_EQ(with_noise.mean(y, x) > 0.0F, confirmed >= noise.min_range && confirmed <= noise.max_range);
      strays.all += z > 0.0F && !(confirmed > 0.0F) ? 1 : 0;
      strays.credible += credible > 0.0F && !(confirmed > 0.0F) ? 1 : 0;
    }
  }
  return strays;
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
  EXPECT_EQ(strays(depth).all, 0);
  depth(cv::Rect(40, 30, 60, 50)) -= 0.7F;
  depth(cv::Rect(110, 0, 2, 120)).setTo(0.9);  // a pole
  depth(cv::Rect(0, 90, 70, 20)).setTo(kNone);
  EXPECT_EQ(strays(depth).all, 0);
  for (const int factor : {2, 3, 4, 5}) EXPECT_EQ(strays(enlarged(depth, factor)).all, 0) << factor;
  depth(20, 20) = 0.6F;
  for (const int factor : {1, 2, 3, 4, 5})
    EXPECT_EQ(strays(enlarged(depth, factor)).all, factor > 3 ? 0 : 1) << "wider gaps hide it: " << factor;
}

TEST(StrayDepth, OneThatARowOrAColumnConfirmsMayBeRight) {
  DepthImage depth = test::constant({80, 60}, 3.0F);
  depth(cv::Rect(20, 20, 9, 1)).setTo(2.0);  // a cable
  depth(cv::Rect(50, 10, 1, 9)).setTo(2.0);
  depth(40, 40) = 2.0F;
  EXPECT_EQ(strays(depth).all, 19);
  EXPECT_EQ(strays(depth).credible, 18);
  depth(cv::Rect(33, 33, 15, 15)).setTo(kNone);
  depth(40, 40) = 2.0F;
  EXPECT_EQ(strays(depth).all, 19);
  EXPECT_EQ(strays(depth).credible, 19) << "alone in a hole, nothing speaks against it";
}

/// What stands beside a pixel may be of another surface, and that raises its variance; but not what is wrong.
TEST(StrayDepth, StepsToCredibleDepthCount) {
  const DepthNoiseModel noise;
  DepthImage depth = test::constant({80, 60}, 3.0F);
  depth(cv::Rect(20, 20, 9, 1)).setTo(2.0);
  depth(40, 40) = 2.0F;
  cv::Mat_<float> of_surface;
  const GaussianDepth with_noise = withNoise(sortStrays(depth, noise), noise, {}, &of_surface);
  EXPECT_GT(with_noise.variance(21, 24), 10.0F * noise.variance(3.0F));
  EXPECT_FLOAT_EQ(of_surface(21, 24), noise.variance(3.0F));
  EXPECT_FLOAT_EQ(with_noise.variance(41, 40), noise.variance(3.0F));
  EXPECT_TRUE(std::isnan(of_surface(20, 24)));
}

TEST(StrayDepth, ADepthByItselfIsOneAlsoWithMuchNoise) {
  DepthImage depth = test::constant({80, 60}, kNone);
  depth(cv::Rect(0, 0, 30, 60)).setTo(4.0);
  depth(30, 60) = 4.0F;
  DepthNoiseModel noise;
  noise.quadratic = 0.1F;
  EXPECT_EQ(strays(depth, noise).all, 1);
  depth.setTo(0.0, depth != depth);
  EXPECT_EQ(strays(depth, noise).all, 1) << "0 is none, too";
}

TEST(StrayDepth, NoiseOfFarDepthIsNoStray) {
  DepthImage depth = test::constant({80, 60}, 4.5F);
  DepthNoiseModel noise;
  noise.quadratic = 5e-3F;
  cv::Mat_<float> errors(depth.size());
  cv::RNG(3).fill(errors, cv::RNG::NORMAL, 0.0, 0.5 * static_cast<double>(noise.sigmaZ(4.5F)));
  depth += errors;
  EXPECT_LT(strays(depth, noise).all, 5);
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
  EXPECT_GT(strays(depth).all, 0.9 * wild);
  EXPECT_LT(strays(depth).credible, 0.5 * wild) << "by themselves, or confirmed by chance";
  DepthNoiseModel paper;
  paper.lateral_sigma = 0.0F;
  EXPECT_EQ(strays(depth, paper).all, 0);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
