// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/scale_estimator.h"

#include <gtest/gtest.h>

#include <functional>
#include <opencv2/imgproc.hpp>

#include "unit/fusion/depth_images.h"

namespace rgbd_sfm_fusion {
namespace {

using test::kNone;
constexpr double kAlpha = 2.5;

enum class StatedVariance { kOfInverseDepth, kOfDepth };

/// A scene, and how SfM sees it.
struct Scene {
  double near = 1.0, far = 4.5;                  ///< [m]
  double sigma = 0.1;                            ///< of SfM's inverse depth, relative to the truth
  double outliers = 0.0;                         ///< share of the pixels
  double outlier_near = 0.2, outlier_far = 5.0;  ///< their range of μ / true μ
  double density = 0.3;                          ///< share of pixels with SfM depth
  StatedVariance stated = StatedVariance::kOfInverseDepth;
};

struct Depths {
  GaussianDepth sfm, sensor;
};

/// `tile_error(x, y)`: relative error of inverse depth that the pixels around (x, y) share.
Depths makeDepths(const Scene& scene, int seed, const cv::Mat_<float>& shared_error = {}) {
  const cv::Size size(320, 240);
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::normal_distribution<double> normal;
  const DepthNoiseModel noise;
  Depths depths{{DepthImage(size, kNone), cv::Mat_<float>(size, kNone)}, {}};
  DepthImage sensor(size, kNone);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double depth =
          scene.near + (scene.far - scene.near) * (0.5 + 0.5 * std::sin(0.02 * x + 0.03 * y));
      sensor(y, x) = static_cast<float>(depth + static_cast<double>(noise.sigmaZ(static_cast<float>(depth))) *
                                                    normal(random));
      if (uniform(random) > scene.density) continue;
      const double rho = kAlpha / depth;
      double error = scene.sigma * normal(random);
      if (!shared_error.empty()) error += static_cast<double>(shared_error(y, x));
      double mu = 1.0 / (rho * (1.0 + error));
      if (uniform(random) < scene.outliers)
        mu = (scene.outlier_near + (scene.outlier_far - scene.outlier_near) * uniform(random)) / rho;
      if (mu <= 0.0) continue;
      const double sigma = scene.sigma > 0.0 ? scene.sigma : 0.02;
      const double stated = scene.stated == StatedVariance::kOfDepth ? sigma * mu : sigma * rho * mu * mu;
      depths.sfm.mean(y, x) = static_cast<float>(mu);
      depths.sfm.variance(y, x) = static_cast<float>(stated * stated);
    }
  }
  DepthNoiseModel axial;
  axial.lateral_sigma = 0.0f;
  depths.sensor = withNoise(sensor, axial);
  return depths;
}

Overlap overlapOf(const Depths& depths, std::size_t max_samples) {
  SfmPoints points;
  const SensorDepth sensor{depths.sensor, {}, {}, {}};
  points.collect(depths.sfm, sensor);
  return collectOverlap(points, sensor, test::smallCamera(), max_samples);
}

ScaleEstimate fit(const Depths& depths, const ScaleOptions& options = {}) {
  return fitScale(overlapOf(depths, Overlap::kMaxSamples), options);
}

/// Mean of α̂/α - 1 over some seeds.
double bias(const Scene& scene, const ScaleOptions& options = {}) {
  constexpr int kRuns = 16;
  double sum = 0.0;
  for (int seed = 0; seed < kRuns; ++seed) sum += fit(makeDepths(scene, seed), options).alpha / kAlpha - 1.0;
  return sum / kRuns;
}

/// The number of pixels is no multiple of the number of lanes, and SfM's unit may be any. The ratios rise
/// from first to last, so a test fails if some are left out.
TEST(ScaleEstimator, RobustFitTakesAllSamplesThatFit) {
  for (const std::size_t count : {203u, 4099u}) {
    for (const double alpha : {1e-3, 1.0, 1e3}) {
      Overlap overlap;
      overlap.pixels = count;
      overlap.sfm_variance.assign(count, static_cast<float>(1e-4 / (alpha * alpha)));
      overlap.sensor.assign(count, 2.0f);
      overlap.sensor_variance.assign(count, 1e-5f);
      for (std::size_t i = 0; i < count; ++i) {
        const double ratio = alpha * (0.99 + 0.02 * static_cast<double>(i) / static_cast<double>(count - 1));
        overlap.sfm.push_back(static_cast<float>(2.0 / ratio));
        overlap.tile.push_back(static_cast<std::uint8_t>(i % 8));
      }
      const ScaleEstimate estimate = fitScale(overlap, {});
      EXPECT_FALSE(estimate.refused);
      EXPECT_NEAR(estimate.alpha / alpha, 1.0, 2e-5) << "of " << count;
      EXPECT_EQ(estimate.inliers, count) << "alpha = " << alpha;
    }
  }
}

TEST(ScaleEstimator, RobustFitHasNoBias) {
  for (const double sigma : {0.0, 0.01, 0.05, 0.1, 0.15}) {
    for (const StatedVariance stated : {StatedVariance::kOfInverseDepth, StatedVariance::kOfDepth}) {
      Scene scene;
      scene.sigma = sigma;
      scene.stated = stated;
      EXPECT_LT(std::abs(bias(scene)), 0.002) << sigma;
    }
  }
}

TEST(ScaleEstimator, RecoversScaleWithFortyPercentOutliers) {
  for (const double sigma : {0.03, 0.1}) {
    Scene scene;
    scene.sigma = sigma;
    scene.outliers = 0.4;
    EXPECT_LT(std::abs(bias(scene)), 0.005) << sigma;
    scene.outlier_far = 0.6;  // all outliers are too near
    EXPECT_LT(std::abs(bias(scene)), 0.005) << sigma;
    scene.outlier_near = 2.0;  // all outliers are too far
    scene.outlier_far = 6.0;
    EXPECT_LT(std::abs(bias(scene)), 0.005) << sigma;
  }
}

TEST(ScaleEstimator, RangesOfDepthMakeNoDifference) {
  for (const auto& [near, far] : {std::pair(0.5, 0.6), std::pair(4.0, 4.9), std::pair(0.5, 4.9)}) {
    Scene scene;
    scene.near = near;
    scene.far = far;
    EXPECT_LT(std::abs(bias(scene)), 0.002) << near;
  }
}

TEST(ScaleEstimator, FewPixelsAreEnough) {
  Scene scene;
  scene.density = 0.005;                    // 400 pixels
  EXPECT_LT(std::abs(bias(scene)), 0.004);  // 0.1 / sqrt(400 * 30) = 0.001
}

TEST(ScaleEstimator, ThePapersEstimatorsAreTheirFormulas) {
  const Depths depths = makeDepths({}, 1);
  double ratios = 0.0, products = 0.0, squares = 0.0, pixels = 0.0;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      const double d = static_cast<double>(depths.sensor.mean(y, x)),
                   mu = static_cast<double>(depths.sfm.mean(y, x));
      if (std::isnan(d) || std::isnan(mu)) continue;
      ratios += d / mu;
      products += d * mu;
      squares += mu * mu;
      pixels += 1.0;
    }
  }
  const Overlap all = overlapOf(depths, 0);
  ScaleOptions options;
  options.estimator = ScaleEstimatorKind::kMeanRatio;
  const ScaleEstimate mean_ratio = fitScale(all, options);
  EXPECT_NEAR(mean_ratio.alpha, ratios / pixels, 1e-9);
  EXPECT_EQ(mean_ratio.inliers, static_cast<std::uint32_t>(pixels));
  options.estimator = ScaleEstimatorKind::kLeastSquares;
  EXPECT_NEAR(fitScale(all, options).alpha, products / squares, 1e-9);
  // Least squares in depth has a known bias (method.md 4). So it is not the default.
  EXPECT_LT(fitScale(all, options).alpha / kAlpha - 1.0, -0.015);
}

TEST(ScaleEstimator, RefusesTooLittle) {
  const ScaleOptions options;
  EXPECT_TRUE(fitScale(Overlap(), options).refused);
  Depths depths = makeDepths({}, 1);
  EXPECT_FALSE(fit(depths).refused);
  for (GaussianDepth* depth : {&depths.sfm, &depths.sensor}) EXPECT_TRUE(test::isConsistent(*depth));
  Depths few = depths;
  few.sfm.mean = DepthImage(depths.sfm.mean.size(), kNone);
  few.sfm.mean.row(100).setTo(1.0);
  few.sfm.mean.row(100).colRange(0, 130).setTo(static_cast<double>(kNone));  // 190 pixels
  EXPECT_TRUE(fit(few).refused);
  Depths corner = depths;
  corner.sfm.mean = DepthImage(depths.sfm.mean.size(), kNone);
  depths.sfm.mean(cv::Rect(0, 0, 80, 80)).copyTo(corner.sfm.mean(cv::Rect(0, 0, 80, 80)));  // 4 tiles
  const ScaleEstimate refused = fit(corner);
  EXPECT_TRUE(refused.refused);
  EXPECT_FALSE(refused.hasScale());
  EXPECT_TRUE(std::isnan(refused.sigma));
  Scene nonsense;
  nonsense.outliers = 1.0;
  nonsense.outlier_near = 1e-3;
  nonsense.outlier_far = 100.0;
  ScaleOptions strict;
  strict.min_inliers = 0.9;
  EXPECT_TRUE(fit(makeDepths(nonsense, 1), strict).refused);
}

/// Errors of neighbouring pixels are alike, so the number of pixels says little about the error of the fit.
TEST(ScaleEstimator, SigmaCoversTheErrorWhenPixelsAreCorrelated) {
  for (const double length : {0.0, 3.0, 6.0}) {  // [px]; a tile is 40 wide
    Scene scene;
    scene.sigma = 0.03;
    ScaleOptions options;
    options.sigma_floor = 0.0;
    double sum = 0.0, beyond_two = 0.0;
    constexpr int kRuns = 80;
    for (int seed = 0; seed < kRuns; ++seed) {
      cv::Mat_<float> shared(240, 320, 0.0f);
      if (length > 0.0) {
        cv::theRNG().state = static_cast<std::uint64_t>(seed) + 1;
        cv::randn(shared, 0.0, 1.0);
        cv::GaussianBlur(shared, shared, {0, 0}, length);
        for (float& value : shared)
          value *= static_cast<float>(0.05 * 2.0 * std::sqrt(M_PI) * length);  // σ = 5 %
      }
      const ScaleEstimate estimate = fit(makeDepths(scene, seed, shared), options);
      const double error = (estimate.alpha - kAlpha) / estimate.sigma;
      sum += std::min(error * error, 25.0);
      beyond_two += std::abs(error) > 2.0 ? 1.0 : 0.0;
    }
    EXPECT_GT(sum / kRuns, 0.6) << length;
    EXPECT_LT(sum / kRuns, 1.5) << length;
    EXPECT_LT(beyond_two / kRuns, 0.15) << length;  // 0.05 if sigma were exact
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
