// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/sensor/depth_noise.h"

#include <gtest/gtest.h>

#include "rgbd_sfm_fusion/sensor/lateral_variance.h"
#include "unit/fusion/depth_images.h"

namespace rgbd_sfm_fusion {
namespace {

using test::kNone;

TEST(DepthNoise, SigmasAreThePapers) {
  const DepthNoiseModel noise;
  EXPECT_FLOAT_EQ(noise.sigmaZ(1.0f), 1.425e-3f);
  EXPECT_FLOAT_EQ(noise.sigmaZ(5.0f), 25.0f * 1.425e-3f);
  const PinholeCamera camera{640, 480, 500.0, 400.0, 320.0, 240.0};
  const Eigen::Vector2f sigma = noise.sigmaXY(camera, 70.0f, 440.0f, 2.0f);
  EXPECT_FLOAT_EQ(sigma.x(), 0.5f * noise.sigmaZ(2.0f));  // left of the centre; σ stays positive
  EXPECT_FLOAT_EQ(sigma.y(), 0.5f * noise.sigmaZ(2.0f));
  EXPECT_FLOAT_EQ(noise.variance(2.0f), std::pow(noise.sigmaZ(2.0f), 2.0f) + 1e-6f);
}

TEST(DepthNoise, NothingOutsideTheRangeAndNothingFromNothing) {
  DepthNoiseModel noise;
  const float inf = std::numeric_limits<float>::infinity();
  DepthImage depth(3, 4, 1.0f);
  noise.far_bias_sigma = 0.0f;
  const float odd[] = {kNone, inf, -inf, 0.0f, -1.0f, 0.399f, 5.001f, 1e-30f, 1e30f};
  for (int i = 0; i < 9; ++i) depth(i / 4, i % 4) = odd[i];
  const GaussianDepth result = withNoise(depth, noise);
  EXPECT_TRUE(test::isConsistent(result));
  for (int i = 0; i < 12; ++i) EXPECT_EQ(std::isnan(result.mean(i / 4, i % 4)), i < 9) << i;
  for (const float value : odd) EXPECT_TRUE(std::isnan(noise.variance(value))) << value;
}

TEST(DepthNoise, BeyondTheRangeDepthIsBiasedButThere) {
  const DepthNoiseModel noise;
  for (const float z : {5.001f, 7.0f, 9.9f}) {
    const float sigma = 0.005f * z * z, own = noise.sigmaZ(z);
    EXPECT_FLOAT_EQ(noise.farVariance(z), sigma * sigma);
    EXPECT_FLOAT_EQ(noise.variance(z), own * own + 1e-6f + sigma * sigma);
    cv::Mat_<float> surface;
    const GaussianDepth result = withNoise(test::constant({31, 17}, z), noise, {}, &surface);
    for (int i = 0; i < 31 * 17; ++i) {
      ASSERT_EQ(result.mean(i / 31, i % 31), z);
      ASSERT_FLOAT_EQ(result.variance(i / 31, i % 31), noise.variance(z));
      ASSERT_FLOAT_EQ(surface(i / 31, i % 31), noise.variance(z)) << "the surface's own, too";
    }
    EXPECT_TRUE(std::isnan(withNoise(test::constant({31, 17}, z), noise.withinRange()).mean(5, 5)));
  }
  EXPECT_EQ(noise.farVariance(5.0f), 0.0f);
  EXPECT_TRUE(std::isnan(noise.variance(1e30f))) << "so far that the bias is all of it";
}

TEST(DepthNoise, ASurfaceThatFacesTheCameraHasNoLateralTerm) {
  const DepthNoiseModel noise;
  for (const float z : {0.4f, 1.0f, 3.3f, 5.0f}) {
    const GaussianDepth result = withNoise(test::constant({31, 17}, z), noise);
    for (const float v : result.variance) EXPECT_FLOAT_EQ(v, noise.variance(z));
  }
}

TEST(DepthNoise, ItsOwnNoiseIsNotTakenForASlope) {
  const DepthNoiseModel noise;
  std::mt19937 random(1);
  for (const float z : {0.8f, 2.0f, 4.5f}) {
    std::normal_distribution<float> normal(z, std::sqrt(noise.variance(z)));
    DepthImage depth(200, 200);
    for (float& value : depth) value = normal(random);
    const GaussianDepth result = withNoise(depth, noise);
    EXPECT_LT(cv::mean(result.variance)[0] / static_cast<double>(noise.variance(z)), 1.15) << z;
  }
}

TEST(DepthNoise, SlopesCostGradientTimesLateralError) {
  const DepthNoiseModel noise;
  const PinholeCamera camera = test::smallCamera();
  const Eigen::Vector3d oblique = Eigen::Vector3d(std::sin(1.1), 0.0, std::cos(1.1));
  const DepthImage depth = test::plane(camera, oblique, 0.5);
  const GaussianDepth result = withNoise(depth, noise);
  for (const cv::Point p : {cv::Point(60, 40), cv::Point(80, 60), cv::Point(159, 50), cv::Point(90, 119)}) {
    const float z = depth(p);
    const float behind = depth(p.y, p.x - 1), ahead = p.x < 159 ? depth(p.y, p.x + 1) : 2.0f * z - behind;
    const float gradient = 0.5f * (ahead - behind);
    const float axial = noise.variance(z);
    const float expected = axial + 0.16f * (gradient * gradient - 2.0f * axial);
    EXPECT_NEAR(result.variance(p) / expected, 1.0f, 0.05f) << p;
  }
}

TEST(DepthNoise, StepsMakeBothSidesUncertainAndOnlyThem) {
  DepthNoiseModel noise;
  for (const float far : {1.3f, 4.0f, 9.0f, kNone}) {  // also beyond the range; a hole is no step
    DepthImage depth(20, 20, 1.0f);
    depth.colRange(10, 20).setTo(static_cast<double>(far));
    const GaussianDepth result = withNoise(depth, noise);
    EXPECT_TRUE(test::isConsistent(result));
    const float expected = std::min(0.1056f * std::pow(far - 1.0f, 2.0f),  // P(N(0, 0.4²) > 1/2)
                                    kMaxRelativeSigma * kMaxRelativeSigma);
    EXPECT_NEAR(result.variance(5, 9), noise.variance(1.0f) + (std::isnan(far) ? 0.0f : expected), 1e-3f)
        << far;
    EXPECT_FLOAT_EQ(result.variance(5, 8), noise.variance(1.0f)) << far;
    if (far != 4.0f) continue;
    EXPECT_GT(result.variance(5, 10), 0.4f);
  }
}

TEST(DepthNoise, NoVarianceExceedsAFifthOfDepth) {
  DepthNoiseModel noise;
  noise.lateral_sigma = 5.0f;
  DepthImage depth(40, 40);
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(0.4f, 5.0f);
  for (float& value : depth) value = uniform(random);
  const GaussianDepth result = withNoise(depth, noise);
  for (int i = 0; i < 1600; ++i) {
    const float z = result.mean(i / 40, i % 40);
    EXPECT_LT(result.variance(i / 40, i % 40), 0.04f * z * z);
  }
}

TEST(DepthNoise, BadOptionsAreNamed) {
  const auto message = [](const DepthNoiseModel& noise) -> std::string {
    try {
      validate(noise);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message(DepthNoiseModel::kinect()), "");
  EXPECT_EQ(message(DepthNoiseModel::preset("astra")), "");
  EXPECT_EQ(message(DepthNoiseModel::preset("xtion")), "");
  EXPECT_EQ(DepthNoiseModel::preset("xtion").max_range, 5.0f);
  DepthNoiseModel noise;
  noise.floor = -1.0f;
  EXPECT_NE(message(noise).find("floor = -1"), std::string::npos);
  noise = {};
  noise.quadratic = kNone;
  EXPECT_NE(message(noise).find("quadratic = nan"), std::string::npos);
  noise = {};
  noise.max_range = 0.3f;  // below min_range
  EXPECT_NE(message(noise).find("max_range = 0.3: expected 0.4 to 100"), std::string::npos);
  EXPECT_THROW(DepthNoiseModel::preset("kinekt"), std::invalid_argument);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
