// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/evidence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "rgbd_sfm_fusion/fusion/gaussian_fusion.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kVariance = 1e-4F;
constexpr SfmOnlyLimits kLimits{0.9, 0.2, true};

class InlierProbability : public testing::Test {
 protected:
  InlierProbability() {
    fusion_.depth.mean = cv::Mat_<float>(60, 80, kNaN);
    fusion_.depth.variance = cv::Mat_<float>(60, 80, kNaN);
    fusion_.provenance = cv::Mat_<std::uint8_t>(60, 80, std::uint8_t{0});
    fusion_.disagreement = cv::Mat_<std::uint8_t>(60, 80, std::uint8_t{0});
    sfm_ = cv::Mat_<float>(60, 80, kNaN);
  }

  void put(const cv::Rect& area, float z, Provenance source) {
    fusion_.depth.mean(area).setTo(z);
    fusion_.depth.variance(area).setTo(kVariance);
    fusion_.provenance(area).setTo(static_cast<double>(source));
    if (source == Provenance::kSfm) sfm_(area).setTo(z);
    auto& count = source == Provenance::kSfm ? fusion_.counts.sfm_only : fusion_.counts.sensor_only;
    count += static_cast<std::uint64_t>(area.area());
  }

  void judge() {
    SensorDepth sensor;
    sensor.depth = {DepthImage(sfm_.size(), kNaN), cv::Mat_<float>(sfm_.size(), kNaN)};
    fusion_.depth.mean.copyTo(sensor.depth.mean, fusion_.provenance == static_cast<int>(Provenance::kSensor));
    fusion_.points.collect(sensor, {sfm_, fusion_.depth.variance});
    judgeSfmOnly(sfm_, AgreementStatistics(), kLimits, fusion_);
  }
  Provenance source(int x, int y) const { return static_cast<Provenance>(fusion_.provenance(y, x)); }
  float variance(int x, int y) const { return fusion_.depth.variance(y, x); }

  GaussianFusion fusion_;
  DepthImage sfm_;
};

TEST_F(InlierProbability, CountsNeighboursThatAgree) {
  put({20, 20, 20, 20}, 2.0F, Provenance::kSfm);
  put({40, 20, 20, 20}, 2.2F, Provenance::kSfm);
  EXPECT_EQ(agreeingNeighbours(sfm_, {30, 30}), 24);
  EXPECT_EQ(agreeingNeighbours(sfm_, {20, 20}), 8);
  EXPECT_EQ(agreeingNeighbours(sfm_, {39, 30}), 14);
  put({0, 0, 5, 5}, 2.0F, Provenance::kSfm);
  EXPECT_EQ(agreeingNeighbours(sfm_, {0, 0}), 8);
}

TEST_F(InlierProbability, DropsWhatIsAlone) {
  put({10, 10, 1, 1}, 2.0F, Provenance::kSfm);
  put({30, 30, 9, 9}, 2.0F, Provenance::kSfm);
  put({60, 30, 1, 1}, 2.0F, Provenance::kSensor);
  judge();
  EXPECT_EQ(source(10, 10), Provenance::kNone);
  EXPECT_TRUE(std::isnan(fusion_.depth.mean(10, 10)));
  EXPECT_TRUE(std::isnan(variance(10, 10)));
  EXPECT_EQ(source(34, 34), Provenance::kSfm);
  EXPECT_EQ(source(60, 30), Provenance::kSensor);
  EXPECT_EQ(fusion_.counts.sfm_only, static_cast<std::uint64_t>(cv::countNonZero(fusion_.provenance == 2)));
}

TEST_F(InlierProbability, AddsNothingWhereAllAroundAgree) {
  put({20, 20, 20, 20}, 2.0F, Provenance::kSfm);
  judge();
  EXPECT_NEAR(variance(30, 30), kVariance, 0.02F * kVariance);
  EXPECT_GT(variance(22, 22), 1.05F * kVariance);  // fewer neighbours agree
}

TEST_F(InlierProbability, BesideASurfaceBehindTheVarianceIsThatOfAMixture) {
  put({20, 0, 20, 60}, 2.0F, Provenance::kSfm);
  put({46, 0, 20, 60}, 2.4F, Provenance::kSensor);  // beyond a gap of six pixels
  judge();
  EXPECT_NEAR(variance(37, 30), kVariance + 0.05F * 0.4F * 0.4F, 2e-4F);
  EXPECT_EQ(variance(50, 30), kVariance);  // the sensor's depth is not judged
  EXPECT_EQ(source(37, 30), Provenance::kSfm);
}

TEST_F(InlierProbability, DropsWhereTheMixtureIsTooWide) {
  put({20, 20, 20, 20}, 2.0F, Provenance::kSfm);
  put({42, 0, 20, 60}, 6.0F, Provenance::kSensor);  // sqrt(0.05) * 4 m is 0.45 Z
  judge();
  EXPECT_EQ(source(39, 30), Provenance::kNone);
  EXPECT_EQ(source(30, 30), Provenance::kSfm);
}

TEST_F(InlierProbability, ASurfaceInFrontChangesNothing) {
  put({20, 0, 20, 60}, 2.0F, Provenance::kSfm);
  put({0, 0, 20, 60}, 1.0F, Provenance::kSensor);
  put({40, 0, 40, 60}, 1.5F, Provenance::kSensor);
  judge();
  for (const int x : {22, 37}) EXPECT_NEAR(variance(x, 30), kVariance, 0.4F * kVariance) << x;
}

TEST_F(InlierProbability, LeavesDisagreementsAlone) {
  put({10, 10, 1, 1}, 2.0F, Provenance::kSfm);
  fusion_.disagreement(10, 10) = static_cast<std::uint8_t>(Disagreement::kSfmKept);
  judge();
  EXPECT_EQ(source(10, 10), Provenance::kSfm);
}

/// A wall at 2 m: the sensor sees it, and SfM has depth of it as an area and as dots.
class AgreementStatisticsTest : public testing::Test {
 protected:
  static constexpr float kSigma = 0.004F;  // [m] that SfM states

  /// @param wild_dots, wild_areas  shares of stripes of 32 px that are half a metre off
  /// @param ratio                  of real over stated sigma
  static AgreementStatistics learn(double wild_dots, double wild_areas, double ratio) {
    AgreementStatistics statistics;
    cv::RNG random(1);
    const cv::Size size(640, 480);
    SensorDepth sensor;
    sensor.depth = {DepthImage(size, 2.0F), cv::Mat_<float>(size, 1e-8F)};
    SfmPoints points;
    for (int frame = 0; frame < 100; ++frame) {
      GaussianDepth sfm{DepthImage(size, kNaN), cv::Mat_<float>(size, kSigma * kSigma)};
      cv::Mat_<float> wild(1, 20);
      for (int i = 0; i < 20; ++i)
        wild(i) = random.uniform(0.0, 1.0) < (i < 10 ? wild_areas : wild_dots) ? 0.5F : 0.0F;
      for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
          if (x >= 320 && (x + y) % 5 != 0) continue;  // dots: no more than four neighbours
          sfm.mean(y, x) =
              2.0F + wild(x / 32) + static_cast<float>(random.gaussian(ratio * static_cast<double>(kSigma)));
        }
      }
      points.collect(sensor, sfm);
      statistics.observe(points, sfm.mean, 5.0F);
    }
    return statistics;
  }
};

TEST_F(AgreementStatisticsTest, BeginsWithPriors) {
  const AgreementStatistics statistics;
  EXPECT_NEAR(inlierProbability({0, 0.0F}, statistics), 0.5, 0.01);
  EXPECT_GT(inlierProbability({12, 0.0F}, statistics), 0.95);
  EXPECT_NEAR(inlierProbability({12, 3.0F}, statistics), inlierProbability({12, 0.0F}, statistics) - 0.05,
              1e-9);
  EXPECT_GT(statistics.varianceFactor(0), 4.0);
  EXPECT_NEAR(statistics.varianceFactor(24), 1.0, 0.02);
}

TEST_F(AgreementStatisticsTest, LearnsTheShareOfOutliersByNeighbours) {
  const AgreementStatistics statistics = learn(0.4, 0.1, 1.0);
  EXPECT_NEAR(statistics.outlierShare(24), 0.1, 0.03);
  EXPECT_NEAR(statistics.outlierShare(4), 0.4, 0.1);
}

TEST_F(AgreementStatisticsTest, LearnsHowFarOffDepthIs) {
  EXPECT_NEAR(learn(0.0, 0.0, 2.0).varianceFactor(24), 4.0, 0.4);
  EXPECT_NEAR(learn(0.0, 0.0, 1.0).varianceFactor(24), 1.0, 0.1);
  EXPECT_EQ(learn(0.0, 0.0, 0.1).varianceFactor(24), 0.5);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
