// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/sfm_calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

namespace rgbd_sfm_fusion {
namespace {

constexpr double kAlpha = 2.5;
constexpr double kMiddle = 0.6;  // [1/m]

/// Errors of inverse depth.
struct Errors {
  double pixel = 0.02, tile = 0.0;  ///< [1/m] sigma of a pixel's own error, and of a tile's
  double slope = 0.0;               ///< [1] error per difference of inverse depth from 0.6 / m
  double wild_share = 0.0;          ///< of pixels that are off by 0.2 / m
  double stated = 0.02;             ///< [1/m] sigma that SfM states
};

/// Each tile has its own depth, between 1 and 5 m.
Overlap makeOverlap(const Errors& errors, std::uint64_t seed) {
  Overlap overlap;
  cv::RNG random(seed);
  for (std::size_t tile = 0; tile < Overlap::kTiles; ++tile) {
    const double of_tile = random.gaussian(errors.tile), rho = random.uniform(0.2, 1.0);
    for (int i = 0; i < 100; ++i) {
      const bool wild = random.uniform(0.0, 1.0) < errors.wild_share;
      const double error =
          of_tile + random.gaussian(errors.pixel) + errors.slope * (rho - kMiddle) + (wild ? 0.2 : 0.0);
      const double z = 1.0 / (rho + error);
      overlap.sfm.push_back(static_cast<float>(z / kAlpha));
      overlap.sfm_variance.push_back(static_cast<float>(std::pow(errors.stated * z * z / kAlpha, 2)));
      overlap.sensor.push_back(static_cast<float>(1.0 / rho));
      overlap.sensor_variance.push_back(1e-8F);
      overlap.tile.push_back(static_cast<std::uint8_t>(tile));
    }
  }
  overlap.pixels = overlap.size();
  return overlap;
}

Overlap makeOverlap(double tile, double wild_share, std::uint64_t seed) {
  Errors errors;
  errors.tile = tile;
  errors.wild_share = wild_share;
  return makeOverlap(errors, seed);
}

TEST(SfmVarianceFactor, IsTheSquareOfRealOverStatedSigma) {
  for (const double ratio : {0.5, 1.0, 2.0, 5.0}) {
    Errors errors;
    errors.wild_share = 0.1;
    errors.stated = errors.pixel / ratio;
    EXPECT_NEAR(std::sqrt(sfmVarianceFactor(makeOverlap(errors, 3), kAlpha)) / ratio, 1.0, 0.2) << ratio;
  }
  EXPECT_TRUE(std::isnan(sfmVarianceFactor(Overlap(), 1.0)));
}

TEST(SfmVarianceFactor, NeedsTwoHundredSamplesOfHoweverManyPixels) {
  Overlap overlap = makeOverlap(Errors(), 3);
  const auto keep = [&](std::size_t samples) {
    for (auto* values : {&overlap.sfm, &overlap.sfm_variance, &overlap.sensor, &overlap.sensor_variance})
      values->resize(samples);
    overlap.tile.resize(samples);
    return sfmVarianceFactor(overlap, kAlpha);
  };
  for (const std::size_t pixels : {std::size_t{200}, std::size_t{1'000'000}}) {
    overlap.pixels = pixels;
    EXPECT_NEAR(sfmVarianceFactor(overlap, kAlpha), 1.0, 0.2) << pixels;
  }
  EXPECT_FALSE(std::isnan(keep(200)));
  EXPECT_TRUE(std::isnan(keep(199)));
}

TEST(SharedInverseDepthSigma, IsThatOfTheTilesNotOfTheirPixels) {
  for (const double shared : {0.01, 0.03}) {
    for (const double wild_share : {0.0, 0.1}) {
      double sum = 0.0;
      for (std::uint64_t seed = 1; seed <= 10; ++seed)
        sum += sharedInverseDepthSigma(makeOverlap(shared, wild_share, seed), kAlpha);
      EXPECT_NEAR(sum / 10.0, shared, 0.2 * shared) << wild_share;
    }
  }
  EXPECT_LT(sharedInverseDepthSigma(makeOverlap(0.0, 0.0, 1), kAlpha), 0.004);
}

TEST(SharedInverseDepthSigma, NeedsTilesWithBothDepths) {
  EXPECT_TRUE(std::isnan(sharedInverseDepthSigma(Overlap(), 1.0)));
  Overlap overlap = makeOverlap(0.01, 0.0, 1);
  for (std::uint8_t& tile : overlap.tile) tile = static_cast<std::uint8_t>(tile % 5);
  EXPECT_TRUE(std::isnan(sharedInverseDepthSigma(overlap, kAlpha)));
}

TEST(Stretch, IsFoundThoughATenthOfThePixelsIsWildAndTilesHaveErrorsOfTheirOwn) {
  for (const double slope : {-0.1, 0.0, 0.05}) {
    Errors errors;
    errors.slope = slope;
    errors.tile = 0.005;
    errors.wild_share = 0.1;
    double squared_error = 0.0, stated = 0.0;
    constexpr int kSeeds = 40;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      const Stretch stretch = fitStretch(makeOverlap(errors, seed), kAlpha);
      squared_error += std::pow(stretch.slope - slope, 2) / kSeeds;
      stated += stretch.slope_variance / kSeeds;
      EXPECT_NEAR(stretch.middle, kMiddle, 0.1);
    }
    EXPECT_LT(std::sqrt(squared_error), 0.006) << slope;
    EXPECT_NEAR(squared_error / stated, 1.0, 0.5) << slope;
  }
}

TEST(Stretch, IsNotTouchedByAFifthOfTheTilesBeingATenthOff) {
  Errors errors;
  errors.slope = 0.05;
  errors.tile = 0.005;
  Overlap overlap = makeOverlap(errors, 1);
  const double before = fitStretch(overlap, kAlpha).slope;
  for (std::size_t i = 0; i < overlap.size(); ++i)
    if (overlap.tile[i] % 5 == 0) overlap.sensor[i] *= 1.1F;
  EXPECT_NEAR(fitStretch(overlap, kAlpha).slope, before, 0.01);
}

TEST(Stretch, NeedsTilesWithBothDepths) {
  EXPECT_TRUE(std::isnan(fitStretch(Overlap(), 1.0).slope));
  Overlap overlap = makeOverlap(0.01, 0.0, 1);
  for (std::uint8_t& tile : overlap.tile) tile = static_cast<std::uint8_t>(tile % 5);
  EXPECT_TRUE(std::isnan(fitStretch(overlap, kAlpha).slope));
}

TEST(SfmCalibration, BelievesWhatIsStatedUntilItHasSeenMore) {
  const SfmErrors terms = SfmCalibration().errors();
  EXPECT_EQ(terms.variance_factor, 1.0);
  EXPECT_EQ(terms.shared_sigma, 0.0);
  EXPECT_EQ(terms.stretch_sigma, 0.0);
}

/// Errors after frames whose slopes alternate between `slope` and -`slope`.
SfmErrors errorsAfter(int frames, double slope) {
  Errors errors;
  errors.tile = 0.005;
  SfmCalibration calibration;
  for (int i = 0; i < frames; ++i) {
    errors.slope = i % 2 == 0 ? slope : -slope;
    calibration.observe(makeOverlap(errors, static_cast<std::uint64_t>(i)), kAlpha);
  }
  return calibration.errors();
}

TEST(SfmCalibration, AStretchIsAVarianceWhicheverItsSign) {
  EXPECT_NEAR(errorsAfter(60, 0.08).stretch_sigma, 0.08, 0.01);
  EXPECT_LT(errorsAfter(60, 0.0).stretch_sigma, 0.004);
}

TEST(SfmCalibration, AStretchThatIsHardlyKnownCountsLittle) {
  Errors errors;
  errors.slope = 1.0;
  errors.tile = 0.1;
  SfmCalibration calibration;
  calibration.observe(makeOverlap(errors, 1), kAlpha);
  errors.slope = 0.02;
  errors.tile = 0.005;
  for (std::uint64_t seed = 2; seed < 12; ++seed) calibration.observe(makeOverlap(errors, seed), kAlpha);
  EXPECT_LT(calibration.errors().stretch_sigma, 0.1);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
