// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/gaussian_fusion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include "rgbd_sfm_fusion/sensor/depth_noise.h"
#include "unit/fusion/depth_images.h"

namespace rgbd_sfm_fusion {
namespace {

using test::kNone;
using test::withRelativeSigma;

GaussianDepth image(const cv::Size& size, float mean, float variance) {
  return {DepthImage(size, mean), cv::Mat_<float>(size, variance)};
}

int provenance(const FusedDepth& fusion, int x, int y) {
  return fusion.provenance(y, x);
}

DepthNoiseModel withCommonScale(double sigma) {
  DepthNoiseModel noise;
  noise.common_scale_sigma = static_cast<float>(sigma);
  noise.common_offset_sigma = 0.0f;
  return noise;
}

FusedDepth fuse(const SensorDepth& sensor, const GaussianDepth& sfm, const GaussianFusionOptions& options,
                const SensorOffsetGain& gain = {}) {
  SfmPoints points;
  if (!sfm.mean.empty()) points.collect(sfm, sensor);
  return rgbd_sfm_fusion::fuse(sensor, points, options, {}, gain);
}

FusedDepth fuse(const GaussianDepth& sensor, const GaussianDepth& sfm, double common,
                const GaussianFusionOptions& options) {
  return fuse({sensor, {}, {}, withCommonScale(common)}, sfm, options);
}

GaussianFusionOptions withoutTest() {
  GaussianFusionOptions options;
  options.test_agreement = false;
  return options;
}

GaussianFusionOptions withoutAlignment() {
  GaussianFusionOptions options;
  options.align_locally = false;
  return options;
}

TEST(GaussianFusion, IsThePapersProductOfGaussians) {
  const FusedDepth fusion = fuse(image({9, 3}, 2.0f, 0.01f), image({9, 3}, 2.3f, 0.03f), 0.0, withoutTest());
  EXPECT_FLOAT_EQ(fusion.depth.mean(1, 4), (2.0f * 0.03f + 2.3f * 0.01f) / 0.04f);
  EXPECT_FLOAT_EQ(fusion.depth.variance(1, 4), 0.03f * 0.01f / 0.04f);
  EXPECT_EQ(provenance(fusion, 4, 1), static_cast<int>(Provenance::kFused));
  EXPECT_EQ(fusion.counts.fused, 27u);
}

TEST(GaussianFusion, IsThePapersProductWithoutAlignmentToo) {
  const GaussianDepth sensor = image({40, 30}, 2.0f, 1e-4f), sfm = image({40, 30}, 2.01f, 3e-4f);
  const FusedDepth printed = fuse(sensor, sfm, 0.0, withoutTest()),
                   tested = fuse(sensor, sfm, 0.0, withoutAlignment());
  EXPECT_TRUE(test::sameBits(tested.depth.mean, printed.depth.mean));
  EXPECT_TRUE(test::sameBits(tested.depth.variance, printed.depth.variance));
}

TEST(GaussianFusion, VarianceNeverExceedsEitherInput) {
  const float variances[] = {1e-12f, 1e-7f, 3.3e-5f, 0.1f, 1.0f, 7.7f, 1e6f};
  for (const float a : variances) {
    for (const float b : variances) {
      for (const float z : {1e-3f, 1.0f, 1e3f}) {
        const FusedDepth fusion = fuse(image({5, 2}, 1.0f, a), image({5, 2}, z, b), 0.0, withoutTest());
        EXPECT_LE(fusion.depth.variance(1, 2), std::min(a, b));
        EXPECT_GT(fusion.depth.variance(1, 2), 0.49f * std::min(a, b));
        EXPECT_GE(fusion.depth.mean(1, 2), std::min(1.0f, z) - 1e-7f);
        EXPECT_LE(fusion.depth.mean(1, 2), std::max(1.0f, z));
      }
    }
  }
}

TEST(GaussianFusion, AnAlignedVarianceNeverExceedsEitherInput) {
  for (const float a : {1e-12f, 1e-7f, 3.3e-5f, 1e-3f}) {
    for (const float b : {1e-12f, 1e-7f, 3.3e-5f, 1e-3f}) {
      const float z = 1.0f + 1.9f * std::sqrt(a + b);
      const FusedDepth fusion = fuse(image({40, 30}, 1.0f, a), image({40, 30}, z, b), 0.0, {});
      ASSERT_EQ(fusion.counts.fused, 1200u);
      for (const cv::Point p : {cv::Point(0, 0), cv::Point(20, 15)}) {
        EXPECT_LE(fusion.depth.variance(p), std::min(a, b));
        EXPECT_GT(fusion.depth.variance(p), 0.3f * std::min(a, b));
        EXPECT_GE(fusion.depth.mean(p), 1.0f - 1e-6f);
        EXPECT_LE(fusion.depth.mean(p), z);
      }
    }
  }
}

/// See evidence.h: 64 pixels by weight, all with the same depths.
TEST(GaussianFusion, AlignmentIsThatOfAGaussianCommonError) {
  const double d = 2.0, m = 2.01, own = std::pow(1.425e-3 * d * d, 2.0) + 1e-6;  // [m], [m²] of the sensor
  for (const double vm : {0.25 * own, 4.0 * own}) {
    const FusedDepth fusion = fuse(image({40, 30}, static_cast<float>(d), static_cast<float>(own)),
                                   image({40, 30}, static_cast<float>(m), static_cast<float>(vm)), 0.0, {});
    const double r = 1.0 / m - 1.0 / d, noise = 9.0 * own / std::pow(d, 4.0) / 64.0,
                 common = 0.5 * vm / std::pow(m, 4.0), s = common / (common + noise);
    const double aligned = 1.0 / (1.0 / m - s * r), va = vm * (1.0 - s / 2.0) * std::pow(aligned / m, 4.0);
    EXPECT_NEAR(static_cast<double>(fusion.depth.mean(15, 20)), d + own / (own + va) * (aligned - d), 1e-6);
    EXPECT_NEAR(static_cast<double>(fusion.depth.variance(15, 20)) / (own * va / (own + va)), 1.0, 1e-4);
  }
}

/// N(0, 1) noise that is constant in squares of pixels.
cv::Mat_<float> noise(const cv::Size& size, int square, std::mt19937* random) {
  std::normal_distribution<float> normal;
  cv::Mat_<float> squares(size.height / square + 1, size.width / square + 1), pixels(size);
  for (float& value : squares) value = normal(*random);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) pixels(y, x) = squares(y / square, x / square);
  }
  return pixels;
}

struct MeanSquares {
  double error = 0.0, nees = 0.0;
};

MeanSquares meanSquares(const GaussianDepth& depth, float truth) {
  MeanSquares result;
  for (int y = 0; y < depth.mean.rows; ++y) {
    for (int x = 0; x < depth.mean.cols; ++x) {
      const auto e = static_cast<double>(depth.mean(y, x) - truth);
      result.error += e * e / static_cast<double>(depth.mean.total());
      result.nees +=
          e * e / static_cast<double>(depth.variance(y, x)) / static_cast<double>(depth.mean.total());
    }
  }
  return result;
}

TEST(GaussianFusion, AlignmentTakesOffWhatSfmsErrorsHaveInCommon) {
  const cv::Size size(640, 480);
  const float truth = 4.0f, sensor_sigma = 1.425e-3f, sfm_sigma = 3e-3f;  // [m], [1/m]
  for (const int alike : {1, 3}) {  // [px] width in which the sensor's pixels err alike
    std::mt19937 random(7);
    const cv::Mat_<float> of_sensor = noise(size, alike, &random), own = noise(size, 1, &random),
                          common = noise(size, 40, &random);
    GaussianDepth sensor = image(size, 0.0f, std::pow(sensor_sigma * truth * truth, 2.0f)),
                  sfm = image(size, 0.0f, std::pow(sfm_sigma * truth * truth, 2.0f));
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        sensor.mean(y, x) = 1.0f / (1.0f / truth + sensor_sigma * of_sensor(y, x));
        sfm.mean(y, x) = 1.0f / (1.0f / truth + sfm_sigma * std::sqrt(0.5f) * (own(y, x) + common(y, x)));
      }
    }
    const MeanSquares aligned = meanSquares(fuse(sensor, sfm, 0.0, {}).depth, truth),
                      apart = meanSquares(fuse(sensor, sfm, 0.0, withoutAlignment()).depth, truth);
    EXPECT_LT(aligned.error, 0.93 * apart.error) << alike;
    EXPECT_NEAR(aligned.nees, 1.0, 0.1) << alike;
  }
}

TEST(GaussianFusion, WhereThereIsOneDepthItIsKept) {
  for (const float variance : {1e-12f, 0.1f, 1e6f}) {
    GaussianDepth sensor = image({33, 2}, 2.0f, variance), sfm = image({33, 2}, 3.0f, 0.2f);
    for (GaussianDepth* depth : {&sensor, &sfm}) depth->mean(0, 7) = depth->variance(0, 7) = kNone;
    sensor.mean(1, 8) = sensor.variance(1, 8) = kNone;
    sfm.mean(1, 9) = sfm.variance(1, 9) = kNone;
    const FusedDepth fusion = fuse(sensor, sfm, 0.0, withoutTest());
    EXPECT_TRUE(test::isConsistent(fusion.depth));
    EXPECT_EQ(fusion.depth.mean(1, 8), 3.0f);
    EXPECT_EQ(fusion.depth.variance(1, 8), 0.2f);
    EXPECT_EQ(fusion.depth.mean(1, 9), 2.0f);
    EXPECT_EQ(fusion.depth.variance(1, 9), variance);
    EXPECT_EQ(provenance(fusion, 7, 0), 0);
    EXPECT_EQ(provenance(fusion, 9, 1), 1);
    EXPECT_EQ(provenance(fusion, 8, 1), 2);
    EXPECT_EQ(provenance(fusion, 10, 1), 3);
    EXPECT_EQ(fusion.counts.total(), 65u);
    EXPECT_EQ(fusion.counts.fused, 63u);
  }
}

TEST(GaussianFusion, WhatBothShareIsNotReduced) {
  const double common = 0.005;
  const FusedDepth fusion = fuse(image({4, 4}, 4.0f, 1e-10f), image({4, 4}, 4.0f, 1e-10f), common, {});
  EXPECT_NEAR(std::sqrt(fusion.depth.variance(2, 2)), 4.0 * common, 1e-5);
}

TEST(GaussianFusion, TheBiasOfFarDepthIsNotReduced) {
  DepthNoiseModel noise = withCommonScale(0.0);
  for (const float z : {noise.max_range, 1.001f * noise.max_range, 6.0f, 9.0f}) {
    const float vd = noise.variance(z), bias = noise.farVariance(z);
    EXPECT_EQ(bias > 0.0f, z > noise.max_range);
    const SensorDepth sensor{image({8, 8}, z, vd), {}, {}, noise};
    for (const float vm : {1e-6f * z * z, 1e-3f * z * z}) {
      const FusedDepth fusion = fuse(sensor, image({8, 8}, 1.01f * z, vm), withoutAlignment());
      ASSERT_EQ(provenance(fusion, 3, 3), 3);
      const float v = fusion.depth.variance(3, 3), gain = vd / (vd + vm);
      EXPECT_GE(v, bias) << z;
      EXPECT_NEAR(v / (gain * gain * vm + (1.0f - gain) * (1.0f - gain) * (vd - bias) + bias), 1.0f, 1e-4f);
      EXPECT_NEAR(fusion.depth.mean(3, 3), z + gain * 0.01f * z, 1e-4f * z) << "but it has a smaller weight";
    }
    const FusedDepth alone = fuse(sensor, GaussianDepth(), {});
    EXPECT_EQ(alone.depth.variance(3, 3), vd);
  }
}

TEST(GaussianFusion, DisagreeingDepthsAreNotAveraged) {
  GaussianDepth sensor = image({40, 30}, 2.0f, 1e-4f), sfm = image({40, 30}, 2.0f, 1e-3f);
  sfm.mean(10, 10) = 2.09f;   // 2.7 σ, as its neighbours agree
  sfm.mean(10, 20) = 2.115f;  // 3.5 σ
  sfm.mean(20, 20) = 1.0f;
  sfm.mean(20, 30) = 100.0f;
  const FusedDepth fusion = fuse(sensor, sfm, 0.0, {});
  EXPECT_EQ(provenance(fusion, 10, 10), 3);
  for (const cv::Point p : {cv::Point(20, 10), cv::Point(20, 20), cv::Point(30, 20)}) {
    EXPECT_EQ(fusion.depth.mean(p), 2.0f);
    EXPECT_EQ(fusion.depth.variance(p), 1e-4f);
    EXPECT_EQ(fusion.provenance(p), 1);
    EXPECT_EQ(fusion.disagreement(p), p.y == 10 ? 0 : static_cast<int>(Disagreement::kSensorKept))
        << "between averaging and contradiction the sensor's is kept without a word";
  }
  EXPECT_EQ(fusion.disagreeing, 2u);
  EXPECT_EQ(fusion.counts.sensor_only, 3u);
  EXPECT_EQ(fusion.counts.fused, 1197u);
  EXPECT_EQ(fuse(sensor, sfm, 0.0, withoutTest()).disagreeing, 0u);
}

TEST(GaussianFusion, NoHaloAtTheSensorsSteps) {
  const DepthNoiseModel noise;
  DepthImage raw(30, 40, 2.0f);
  raw.colRange(20, 40).setTo(2.3);
  SensorDepth sensor;
  sensor.depth = withNoise(raw, noise, {}, &sensor.surface_variance);
  sensor.noise = withCommonScale(0.0);
  GaussianDepth sfm = image({40, 30}, 2.0f, 1e-4f);
  sfm.mean.colRange(20, 40).setTo(2.3);
  sfm.mean(10, 19) = 2.15f;  // half-way; likely only if the step's variance counted
  const FusedDepth fusion = fuse(sensor, sfm, {});
  EXPECT_EQ(fusion.depth.mean(10, 19), 2.0f);
  EXPECT_EQ(fusion.depth.variance(10, 19), sensor.depth.variance(10, 19)) << "the step included";
  EXPECT_EQ(provenance(fusion, 19, 10), 1);
  EXPECT_EQ(fusion.disagreement(10, 19), 0);
  EXPECT_EQ(provenance(fusion, 19, 11), 3) << "of the pixel's own surface";
  EXPECT_EQ(provenance(fusion, 20, 11), 3);
  EXPECT_LT(fusion.depth.variance(11, 19), 1e-4f);
}

TEST(GaussianFusion, AFalseAreaOfTheSensorIsFlaggedAndNotAveraged) {
  const DepthNoiseModel noise;
  const cv::Size size(160, 120);
  DepthImage raw(size, 1.3f);
  const cv::Rect block(50, 30, 60, 60);
  for (const float depth_there : {0.8f, 0.35f}) {  // in range, and nearer than the range
    raw(block).setTo(static_cast<double>(depth_there));
    SensorDepth sensor;
    sensor.depth = withNoise(raw, noise, {}, &sensor.surface_variance);
    sensor.of_any_range = raw;
    sensor.noise = withCommonScale(0.0);
    GaussianDepth sfm = image(size, kNone, kNone);
    std::mt19937 random(3);
    std::normal_distribution<float> normal;
    int there = 0, flagged = 0, averaged = 0, wrong = 0;
    for (int y = 0; y < size.height; ++y) {
      for (int x = y % 3; x < size.width; x += 3) {
        const float sigma = (x + y) % 2 == 0 ? 0.02f : 0.055f;  // averaged up to 0.0585
        sfm.mean(y, x) = 1.3f + sigma * normal(random);
        sfm.variance(y, x) = sigma * sigma;
      }
    }
    const FusedDepth fusion = fuse(sensor, sfm, {});
    for (int y = 0; y < size.height; ++y) {
      for (int x = y % 3; x < size.width; x += 3) {
        if (!block.contains({x, y})) {
          wrong += fusion.provenance(y, x) == 3 ? 0 : 1;
          continue;
        }
        ++there;
        flagged += fusion.disagreement(y, x) != 0 ? 1 : 0;
        averaged += fusion.provenance(y, x) == 3 ? 1 : 0;
        EXPECT_NEAR(fusion.depth.mean(y, x), depth_there > 0.4f ? 0.8f : sfm.mean(y, x), 1e-4f);
      }
    }
    EXPECT_GT(flagged, 95 * there / 100) << depth_there;
    EXPECT_LE(averaged, there / 200) << "at its corners, which lie in areas that mostly agree";
    EXPECT_LT(wrong, 800) << "of the 5200 around it, those beside the block and those beyond the limit";
    EXPECT_EQ(fusion.counts.total(), static_cast<std::uint64_t>(cv::countNonZero(fusion.provenance)));
    EXPECT_EQ(fusion.disagreeing, static_cast<std::uint64_t>(cv::countNonZero(fusion.disagreement)));
  }
}

TEST(GaussianFusion, ASurfaceThatIsContradictedAroundConfirmsNothing) {
  const GaussianDepth sensor = image({80, 40}, 1.0f, 1e-6f);
  for (const bool contradicted : {false, true}) {
    GaussianDepth sfm = withRelativeSigma(DepthImage(40, 80, kNone), 0.03f);
    sfm.variance.setTo(9e-4);
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 80; ++x) sfm.mean(y, x) = contradicted && (x + y) % 3 != 0 ? 2.0f : 1.01f;
    }
    const FusedDepth fusion = fuse(sensor, sfm, 0.0, {});
    EXPECT_EQ(provenance(fusion, 40, 20), contradicted ? 1 : 3);
    EXPECT_EQ(fusion.disagreement(20, 40), 0) << "it does not contradict the sensor itself";
    EXPECT_EQ(fusion.counts.fused, contradicted ? 0u : 3200u);
    EXPECT_EQ(fusion.disagreeing, static_cast<std::uint64_t>(cv::countNonZero(sfm.mean == 2.0f)));
  }
}

/// Depth that may be of another surface nearby needs more evidence around it.
TEST(GaussianFusion, UncertainDepthConfirmsLess) {
  const GaussianDepth sensor = image({80, 40}, 1.0f, 1e-6f);
  for (const float sigma : {0.01f, 0.15f}) {
    GaussianDepth sfm = image({80, 40}, kNone, kNone);
    sfm.mean(18, 17) = 1.0f;
    sfm.variance(18, 17) = sigma * sigma;
    EXPECT_EQ(fuse(sensor, sfm, 0.0, {}).counts.fused, sigma < 0.1f ? 1u : 0u);
  }
}

TEST(GaussianFusion, AnOffsetOfTheSensorIsInEveryVariance) {
  GaussianDepth sensor = image({40, 30}, 2.0f, 1e-4f), sfm = image({40, 30}, 2.0f, 1e-4f);
  sensor.mean.colRange(0, 10).setTo(static_cast<double>(kNone));
  sensor.variance.colRange(0, 10).setTo(static_cast<double>(kNone));
  DepthNoiseModel noise = withCommonScale(0.0);
  const SensorOffsetGain gain{0.5f, 0.01f, 0.02f, 3.0f};
  const auto fused = [&] { return fuse({sensor, {}, {}, noise}, sfm, withoutTest(), gain).depth.variance; };
  const cv::Mat_<float> before = fused();
  noise.common_offset_sigma = 0.002f;
  const cv::Mat_<float> after = fused();
  EXPECT_NEAR(after(4, 20) - before(4, 20), std::pow(0.002f * 2.0f * 2.0f, 2.0f), 1e-8f) << "both";
  const float of_sfm = 0.5f + 0.01f * 5.0f + 0.02f * 4.0f + 3.0f / 2.0f;
  EXPECT_NEAR(after(4, 5) - before(4, 5), std::pow(0.002f * of_sfm * 2.0f * 2.0f, 2.0f), 1e-7f) << "SfM";
}

/// Accepted measurements of one depth, fused one after the other.
TEST(GaussianFusion, TheOrderOfMeasurementsMakesNoDifference) {
  std::vector<std::pair<float, float>> measurements = {
      {2.0f, 1e-4f}, {2.01f, 3e-4f}, {1.98f, 1e-3f}, {2.03f, 4e-3f}, {1.995f, 2e-5f}};
  const auto fuseAll = [&] {
    GaussianDepth depth = image({3, 3}, measurements[0].first, measurements[0].second);
    for (std::size_t i = 1; i < measurements.size(); ++i)
      depth =
          fuse(depth, image({3, 3}, measurements[i].first, measurements[i].second), 0.0, withoutAlignment())
              .depth;
    return std::make_pair(depth.mean(1, 1), depth.variance(1, 1));
  };
  const auto expected = fuseAll();
  std::mt19937 random(4);
  for (int i = 0; i < 20; ++i) {
    std::shuffle(measurements.begin(), measurements.end(), random);
    const auto result = fuseAll();
    EXPECT_NEAR(result.first / expected.first, 1.0f, 1e-6f);
    EXPECT_NEAR(result.second / expected.second, 1.0f, 1e-5f);
  }
}

TEST(ProvenanceCounts, AddUpAndShare) {
  ProvenanceCounts counts;
  EXPECT_EQ(counts.fusedShare(), 0.0);
  counts += {60, 10, 30};
  counts += {40, 10, 50};
  EXPECT_DOUBLE_EQ(counts.sensorOnlyShare(), 0.5);
  EXPECT_DOUBLE_EQ(counts.sfmOnlyShare(), 0.1);
  EXPECT_DOUBLE_EQ(counts.fusedShare(), 0.4);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
