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
constexpr float kFloor = 0.02F * 0.02F;  // variance at 2 m that is added to all
constexpr double kProbability = 0.9, kMaxRelativeSigma = 0.2;

class InlierProbability : public testing::Test {
 protected:
  InlierProbability() {
    fusion_.depth.mean = cv::Mat_<float>(60, 80, kNaN);
    fusion_.depth.variance = cv::Mat_<float>(60, 80, kNaN);
    fusion_.provenance = cv::Mat_<std::uint8_t>(60, 80, std::uint8_t{0});
    fusion_.disagreement = cv::Mat_<std::uint8_t>(60, 80, std::uint8_t{0});
  }

  void put(const cv::Rect& area, float z, Provenance source) {
    fusion_.depth.mean(area).setTo(z);
    fusion_.depth.variance(area).setTo(kVariance);
    fusion_.provenance(area).setTo(static_cast<double>(source));
    auto& count = source == Provenance::kSfm ? fusion_.counts.sfm_only : fusion_.counts.sensor_only;
    count += static_cast<std::uint64_t>(area.area());
  }

  void judge() { judgeSfmOnly(kProbability, kMaxRelativeSigma, fusion_); }
  Provenance source(int x, int y) const { return static_cast<Provenance>(fusion_.provenance(y, x)); }
  float variance(int x, int y) const { return fusion_.depth.variance(y, x); }

  GaussianFusion fusion_;
};

TEST_F(InlierProbability, DropsWhatIsAlone) {
  put({10, 10, 1, 1}, 2.0F, Provenance::kSfm);
  put({30, 30, 5, 5}, 2.0F, Provenance::kSfm);
  put({60, 30, 1, 1}, 2.0F, Provenance::kSensor);
  judge();
  EXPECT_EQ(source(10, 10), Provenance::kNone);
  EXPECT_TRUE(std::isnan(fusion_.depth.mean(10, 10)));
  EXPECT_TRUE(std::isnan(variance(10, 10)));
  EXPECT_EQ(source(32, 32), Provenance::kSfm);
  EXPECT_EQ(fusion_.counts.sfm_only, 25u);
  EXPECT_EQ(source(60, 30), Provenance::kSensor);
}

TEST_F(InlierProbability, AddsButAFloorWhereAllAroundAgree) {
  put({20, 20, 20, 20}, 2.0F, Provenance::kSfm);
  judge();
  EXPECT_FLOAT_EQ(variance(30, 30), kVariance + kFloor);
  EXPECT_GT(variance(20, 20), 1.1F * kVariance + kFloor);  // a corner has eight that agree
  EXPECT_EQ(fusion_.counts.sfm_only, 400u);
}

TEST_F(InlierProbability, BesideASurfaceBehindTheVarianceIsThatOfAMixture) {
  put({20, 20, 20, 20}, 2.0F, Provenance::kSfm);
  put({46, 0, 20, 60}, 2.4F, Provenance::kSensor);  // beyond a gap of six pixels
  judge();
  EXPECT_NEAR(variance(39, 30), kVariance + kFloor + 0.05F * 0.4F * 0.4F, 1e-4F);
  EXPECT_FLOAT_EQ(variance(30, 30), kVariance + kFloor);  // too far from the edge
  EXPECT_EQ(variance(50, 30), kVariance);                 // the sensor's is not judged
  EXPECT_EQ(source(39, 30), Provenance::kSfm);
}

TEST_F(InlierProbability, DropsWhereTheMixtureIsTooWide) {
  put({20, 20, 20, 20}, 2.0F, Provenance::kSfm);
  put({42, 0, 20, 60}, 6.0F, Provenance::kSensor);  // sqrt(0.05) * 4 m is 0.45 Z
  judge();
  EXPECT_EQ(source(39, 30), Provenance::kNone);
  EXPECT_EQ(source(30, 30), Provenance::kSfm);
}

TEST_F(InlierProbability, ASurfaceInFrontOrTooFarAwayChangesNothing) {
  put({20, 20, 20, 20}, 2.0F, Provenance::kSfm);
  put({0, 0, 18, 60}, 1.0F, Provenance::kSensor);
  put({60, 0, 20, 60}, 2.5F, Provenance::kSensor);
  judge();
  EXPECT_FLOAT_EQ(variance(20, 30), kVariance + kFloor);
  EXPECT_FLOAT_EQ(variance(39, 30), kVariance + kFloor);
}

TEST_F(InlierProbability, LeavesDisagreementsAlone) {
  put({10, 10, 1, 1}, 2.0F, Provenance::kSfm);
  fusion_.disagreement(10, 10) = static_cast<std::uint8_t>(Disagreement::kSfmKept);
  judge();
  EXPECT_EQ(source(10, 10), Provenance::kSfm);
}

TEST_F(InlierProbability, IsThatOfTheSharesItWasFittedTo) {
  EXPECT_NEAR(inlierProbability({0, 0.0F}), 0.80, 0.01);
  EXPECT_NEAR(inlierProbability({1, 0.0F}), 0.90, 0.01);
  EXPECT_NEAR(inlierProbability({4, 0.0F}), 0.97, 0.02);
  EXPECT_LT(inlierProbability({4, 3.0F}), inlierProbability({4, 0.0F}));
}

}  // namespace
}  // namespace rgbd_sfm_fusion
