// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/inlier_probability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rgbd_sfm_fusion {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kVariance = 1e-4F;
constexpr SfmOnlyLimits kLimits{0.9, 0.2};

class InlierProbability : public testing::Test {
 protected:
  InlierProbability() {
    const cv::Size size(160, 120);
    fusion_.depth.mean = cv::Mat_<float>(size, kNaN);
    fusion_.depth.variance = cv::Mat_<float>(size, kNaN);
    fusion_.provenance = cv::Mat_<std::uint8_t>(size, std::uint8_t{0});
    fusion_.disagreement = cv::Mat_<std::uint8_t>(size, std::uint8_t{0});
    sfm_ = cv::Mat_<float>(size, kNaN);
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
  EXPECT_EQ(agreeingNeighbours(sfm_, {30, 30}, 2), 24);
  EXPECT_EQ(agreeingNeighbours(sfm_, {20, 20}, 2), 8);
  EXPECT_EQ(agreeingNeighbours(sfm_, {39, 30}, 2), 14);
  put({0, 0, 5, 5}, 2.0F, Provenance::kSfm);
  EXPECT_EQ(agreeingNeighbours(sfm_, {0, 0}, 2), 8);
}

TEST_F(InlierProbability, WideNeighboursTellAContourFromASurface) {
  put({0, 10, 160, 6}, 2.0F, Provenance::kSfm);   // a band as along a contour
  put({40, 40, 80, 80}, 2.0F, Provenance::kSfm);  // a surface
  EXPECT_EQ(agreeingNeighbours(sfm_, {80, 12}, kWideSpacing), 4);
  EXPECT_EQ(agreeingNeighbours(sfm_, {80, 80}, kWideSpacing), 24);
  EXPECT_GT(agreeingNeighbours(sfm_, {80, 12}, kNearSpacing), 12);  // near ones do not tell
}

TEST_F(InlierProbability, DropsWhatIsAlone) {
  put({10, 10, 1, 1}, 2.0F, Provenance::kSfm);
  put({30, 30, 9, 9}, 2.0F, Provenance::kSfm);
  put({90, 30, 1, 1}, 2.0F, Provenance::kSensor);
  judge();
  EXPECT_EQ(source(10, 10), Provenance::kNone);
  EXPECT_TRUE(std::isnan(fusion_.depth.mean(10, 10)));
  EXPECT_TRUE(std::isnan(variance(10, 10)));
  EXPECT_EQ(source(34, 34), Provenance::kSfm);
  EXPECT_EQ(source(90, 30), Provenance::kSensor);
  EXPECT_EQ(fusion_.counts.sfm_only, static_cast<std::uint64_t>(cv::countNonZero(fusion_.provenance == 2)));
}

TEST_F(InlierProbability, TheVarianceIsThatOfAMixtureWhereASurfaceEnds) {
  put({0, 10, 160, 6}, 2.0F, Provenance::kSfm);
  put({40, 40, 80, 80}, 2.0F, Provenance::kSfm);
  judge();
  EXPECT_NEAR(variance(80, 80), kVariance, 0.3F * kVariance);
  // Along a contour, 4 neighbours agree. The priors: 0.06 exp(-4 / 3) of such pixels are 0.55 Z off, by RMS.
  EXPECT_NEAR(variance(80, 12), kVariance + 0.3F * 0.06F * std::exp(-4.0F / 3.0F) * 2.0F * 2.0F, 1e-4F);
  EXPECT_GT(variance(42, 42), 4.0F * kVariance);  // a corner
}

/// Agreement is counted for blocks of pixels at once.
TEST_F(InlierProbability, EveryPixelIsJudgedByItsOwnNeighbours) {
  cv::RNG random(1);
  for (int i = 0; i < 400; ++i) {
    const cv::Rect area(random.uniform(0, 150), random.uniform(0, 110), random.uniform(1, 10), 3);
    put(area, random.uniform(2.0F, 2.4F), Provenance::kSfm);
  }
  judge();
  const AgreementStatistics statistics;
  for (int y = 0; y < sfm_.rows; ++y) {
    for (int x = 0; x < sfm_.cols; ++x) {
      if (!(sfm_(y, x) > 0.0F)) continue;
      const Agreement agreement = agreementAt(sfm_, {x, y});
      const bool is_kept = statistics.inlierProbability(agreement) >= kLimits.min_probability;
      ASSERT_EQ(source(x, y), is_kept ? Provenance::kSfm : Provenance::kNone) << x << ", " << y;
      if (!is_kept) continue;
      const auto step = static_cast<float>(statistics.stepVariance(agreement.wide));
      ASSERT_FLOAT_EQ(variance(x, y), kVariance + step * sfm_(y, x) * sfm_(y, x)) << x << ", " << y;
    }
  }
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
      statistics.observe(points, sfm.mean, 5.0F, 0.5);
    }
    return statistics;
  }
};

TEST_F(AgreementStatisticsTest, BeginsWithPriors) {
  const AgreementStatistics statistics;
  EXPECT_NEAR(statistics.inlierProbability({0, 24}), 0.5, 0.01);
  EXPECT_GT(statistics.inlierProbability({12, 24}), 0.95);
  EXPECT_NEAR(statistics.inlierProbability({24, 0}), 1.0 - 0.06, 0.01);
  EXPECT_NEAR(statistics.stepVariance(0), 0.06 * 0.3, 1e-9);
  EXPECT_LT(statistics.stepVariance(24), 1e-5);
}

TEST_F(AgreementStatisticsTest, LearnsTheShareOfOutliersByNeighbours) {
  const AgreementStatistics statistics = learn(0.4, 0.1, 1.0);
  EXPECT_NEAR(statistics.inlierProbability({24, 24}), 0.95, 0.05);
  EXPECT_LT(statistics.inlierProbability({24, 12}), statistics.inlierProbability({24, 24}));  // a stripe
  EXPECT_NEAR(statistics.inlierProbability({4, 4}), 0.6, 0.1);
}

TEST_F(AgreementStatisticsTest, LearnsHowFarOtherSurfacesAre) {
  // Stripes at 2.5 m before a wall at 2 m are off by a fifth of their depth.
  EXPECT_NEAR(learn(0.0, 0.5, 1.0).stepVariance(12), 0.5 * 0.2 * 0.2, 0.005);
  EXPECT_LT(learn(0.0, 0.0, 1.0).stepVariance(24), 1e-5);
}

TEST_F(AgreementStatisticsTest, APrioriStepsOutlastFramesThatShowNone) {
  const AgreementStatistics begin, later = learn(0.0, 0.0, 1.0);
  // Four wide neighbours of each dot agree.
  EXPECT_LT(later.stepVariance(4), 0.5 * begin.stepVariance(4));
  EXPECT_GT(later.stepVariance(4), 0.02 * begin.stepVariance(4));
}

}  // namespace
}  // namespace rgbd_sfm_fusion
