// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/evidence.h"

#include <gtest/gtest.h>

#include <cmath>

#include "unit/fusion/depth_images.h"

namespace rgbd_sfm_fusion {
namespace {

using test::kNone;

constexpr float kRho = 0.5f, kSigma = 0.002f;     // [1/m] of the sensor
constexpr float kError = 0.003f;                  // [1/m] of SfM
constexpr float kPixels = 16.0f + 32.0f + 16.0f;  // by weight: cell, cells beside it, cells at corners

float variance(float sigma, float rho) {
  return std::pow(sigma / (rho * rho), 2.0f);
}

/// Variance of a mean over so many pixels, by weight.
float noiseVariance(float pixels) {
  return 9.0f * kSigma * kSigma / pixels;
}

class EvidenceTest : public testing::Test {
 protected:
  EvidenceTest() {
    sensor_.depth = {DepthImage(size_, 1.0f / kRho), cv::Mat_<float>(size_, variance(kSigma, kRho))};
    sensor_.noise.quadratic = kSigma;
    sensor_.noise.floor = 0.0f;
  }

  Evidence find() const {
    SfmPoints points;
    points.collect({sfm_, cv::Mat_<float>(size_, variance(kSigma, kRho))}, sensor_);
    return evidenceAround(sensor_, points, 5.0f);
  }

  /// That both depths of a pixel are of one surface, before the two are compared.
  float probability(int y, int x) const {
    return 1.0f / (1.0f + std::exp(-find().odds(y / Evidence::kCell, x / Evidence::kCell)));
  }

  static void expectNear(float actual, float expected) { EXPECT_NEAR(actual, expected, 1e-3f * expected); }

  const cv::Size size_{42, 31};  // not multiples of a cell's size
  SensorDepth sensor_;
  DepthImage sfm_{size_, 1.0f / (kRho + kError)};
};

TEST_F(EvidenceTest, AreMeansOverNeighbours) {
  const Evidence errors = find();
  ASSERT_EQ(errors.difference.size(), cv::Size(11, 8));
  for (const float difference : errors.difference) expectNear(difference, kError);
  expectNear(errors.noise_variance(3, 5), noiseVariance(kPixels));
  expectNear(errors.noise_variance(0, 0), noiseVariance(16.0f + 16.0f + 4.0f));
}

TEST_F(EvidenceTest, PreciseDepthCountsMore) {
  sensor_.depth.mean.colRange(20, 22).setTo(
      1.0);  // half of a cell, at half the depth, as precise in inverse depth
  sensor_.depth.variance.colRange(20, 22).setTo(static_cast<double>(variance(kSigma, 1.0f)));
  sfm_.colRange(20, 22).setTo(1.0);
  expectNear(find().difference(3, 5), kError * (1.0f - 0.5f / 2.0f));
  sensor_.depth.variance.colRange(20, 22) *= 4.0;
  sensor_.noise.quadratic *= 2.0f;
  expectNear(find().difference(3, 5), kError * (1.0f - 0.125f / 1.625f));
}

TEST_F(EvidenceTest, OfTheSensorsVarianceOnlyNoiseAveragesOut) {
  sensor_.surface_variance = sensor_.depth.variance.clone();
  sensor_.depth.variance *= 4.0;  // a step
  sensor_.noise.quadratic = 0.5f * kSigma;
  const Evidence errors = find();
  expectNear(errors.difference(3, 5), kError);
  expectNear(errors.noise_variance(3, 5), 4.0f * noiseVariance(kPixels));
}

TEST_F(EvidenceTest, OnlyPixelsThatAgreeCount) {
  for (int y = 0; y < size_.height; ++y) {
    for (int x = 0; x < size_.width; ++x) {
      if ((x + y) % 4 == 0) continue;
      sfm_(y, x) = x % 2 == 0 ? kNone : 17.0f;
      if (x % 3 == 0) sensor_.depth.mean(y, x) = sensor_.depth.variance(y, x) = kNone;
    }
  }
  const Evidence errors = find();
  for (const float difference : errors.difference) expectNear(difference, kError);
  expectNear(errors.noise_variance(3, 5), noiseVariance(kPixels / 4.0f));
}

TEST_F(EvidenceTest, AreThoseAroundOnly) {
  sfm_.colRange(0, 4).setTo(static_cast<double>(1.0f / (kRho - kError)));
  sfm_.colRange(20, size_.width).setTo(static_cast<double>(kNone));
  const Evidence errors = find();
  EXPECT_NEAR(errors.difference(3, 0), kError * (-1.0f + 0.5f) / 1.5f, 1e-5f);
  EXPECT_NEAR(errors.difference(3, 1), kError * (-0.5f + 1.5f) / 2.0f, 1e-5f);
  expectNear(errors.difference(3, 2), kError);
  expectNear(errors.difference(3, 5), kError);
  EXPECT_EQ(errors.difference(3, 6), 0.0f);
  EXPECT_TRUE(std::isinf(errors.noise_variance(3, 6)));
}

TEST_F(EvidenceTest, AgreementAndContradictionAreCounted) {
  sfm_.colRange(0, 20).setTo(17.0);
  expectNear(probability(12, 32), (kPixels + 1.0f) / (kPixels + 2.0f));
  expectNear(probability(12, 4), 1.0f / (kPixels + 2.0f));
  expectNear(probability(12, 20), (48.0f + 1.0f) / (kPixels + 2.0f));
  sfm_.setTo(static_cast<double>(kNone));
  EXPECT_EQ(probability(12, 32), 0.5f) << "nothing is known";
}

}  // namespace
}  // namespace rgbd_sfm_fusion
