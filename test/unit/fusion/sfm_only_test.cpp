// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/sfm_only.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rgbd_sfm_fusion {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kVariance = 1e-4F;
constexpr SfmOnlyLimits kLimits{0.9, 0.2};

class SfmOnly : public testing::Test {
 protected:
  SfmOnly() {
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
    SfmPoints points;
    points.collect({sfm_, fusion_.depth.variance}, sensor);
    judgeSfmOnly(points, sfm_, OtherSurfaces(), kLimits, fusion_);
  }
  Provenance source(int x, int y) const { return static_cast<Provenance>(fusion_.provenance(y, x)); }
  float variance(int x, int y) const { return fusion_.depth.variance(y, x); }

  FusedDepth fusion_;
  DepthImage sfm_;
};

TEST_F(SfmOnly, CountsNeighboursThatAgree) {
  put({20, 20, 20, 20}, 2.0F, Provenance::kSfm);
  put({40, 20, 20, 20}, 2.2F, Provenance::kSfm);
  EXPECT_EQ(agreeingNeighbours(sfm_, {30, 30}, 4), 24);
  EXPECT_EQ(agreeingNeighbours(sfm_, {20, 20}, 4), 8);
  EXPECT_EQ(agreeingNeighbours(sfm_, {39, 30}, 4), 14);
  put({0, 0, 5, 5}, 2.0F, Provenance::kSfm);
  EXPECT_EQ(agreeingNeighbours(sfm_, {0, 0}, 4), 8);
}

TEST_F(SfmOnly, WideNeighboursTellAContourFromASurface) {
  put({0, 10, 160, 6}, 2.0F, Provenance::kSfm);   // a band as along a contour
  put({40, 40, 80, 80}, 2.0F, Provenance::kSfm);  // a surface
  EXPECT_EQ(agreeingNeighbours(sfm_, {80, 12}, kWideRadius), 4);
  EXPECT_EQ(agreeingNeighbours(sfm_, {80, 80}, kWideRadius), 24);
  EXPECT_GT(agreeingNeighbours(sfm_, {80, 12}, kNearRadius), 12);  // near ones do not tell
}

TEST_F(SfmOnly, DropsWhatIsAlone) {
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

TEST_F(SfmOnly, TheVarianceIsThatOfAMixtureWhereASurfaceEnds) {
  put({0, 10, 160, 6}, 2.0F, Provenance::kSfm);
  put({40, 40, 80, 80}, 2.0F, Provenance::kSfm);
  judge();
  // All neighbours agree: a pixel in 2 * 13 * 13 is 0.55 Z off, by RMS.
  EXPECT_NEAR(variance(80, 80), kVariance + 0.3F / (2.0F * 13.0F * 13.0F) * 2.0F * 2.0F, 1e-4F);
  // Along a contour, 4 wide neighbours agree, and 14 near ones.
  EXPECT_NEAR(variance(80, 12), kVariance + 0.3F / (2.0F * 3.0F * 8.0F) * 2.0F * 2.0F, 1e-4F);
  EXPECT_GT(variance(42, 42), 2.0F * variance(80, 80));  // a corner
}

/// Agreement is counted for blocks of pixels at once.
TEST_F(SfmOnly, EveryPixelIsJudgedByItsOwnNeighbours) {
  cv::RNG random(1);
  for (int i = 0; i < 400; ++i) {
    const cv::Rect area(random.uniform(0, 150), random.uniform(0, 110), random.uniform(1, 10), 3);
    put(area, random.uniform(2.0F, 2.4F), Provenance::kSfm);
  }
  judge();
  const OtherSurfaces others;
  std::size_t kept = 0;
  for (int y = 0; y < sfm_.rows; ++y) {
    for (int x = 0; x < sfm_.cols; ++x) {
      const float z = sfm_(y, x);
      if (!(z > 0.0F) || source(x, y) == Provenance::kNone) continue;
      const auto where_seen = static_cast<float>(others.whereSeen(agreementAt(sfm_, {x, y})));
      ASSERT_FLOAT_EQ(variance(x, y), kVariance + others.inHole(where_seen, z) * z * z) << x << ", " << y;
      ++kept;
    }
  }
  EXPECT_GT(kept, 1000U);
}

TEST_F(SfmOnly, LeavesDisagreementsAlone) {
  put({10, 10, 1, 1}, 2.0F, Provenance::kSfm);
  fusion_.disagreement(10, 10) = static_cast<std::uint8_t>(Disagreement::kSfmKept);
  judge();
  EXPECT_EQ(source(10, 10), Provenance::kSfm);
}

/// A wall at 2 m: the sensor sees it, and SfM has depth of it as an area and as dots.
class OtherSurfacesTest : public testing::Test {
 protected:
  static constexpr float kSigma = 0.004F;  // [m] that SfM states

  /// @param wild_dots, wild_areas  shares of stripes of 32 px that are half a metre off
  /// @param hole   columns from this one on are a hole of the sensor; SfM has depth there at `behind`
  static OtherSurfaces learn(double wild_dots, double wild_areas, int hole = 640, float behind = 2.0F) {
    OtherSurfaces others;
    cv::RNG random(1);
    const cv::Size size(640, 480);
    SensorDepth sensor;
    sensor.depth = {DepthImage(size, 2.0F), cv::Mat_<float>(size, 1e-8F)};
    sensor.depth.mean.colRange(hole, size.width).setTo(kNaN);
    SfmPoints points;
    for (int frame = 0; frame < 100; ++frame) {
      GaussianDepth sfm{DepthImage(size, kNaN), cv::Mat_<float>(size, kSigma * kSigma)};
      cv::Mat_<float> wild(1, 20);
      for (int i = 0; i < 20; ++i)
        wild(i) = random.uniform(0.0, 1.0) < (i < 10 ? wild_areas : wild_dots) ? 0.5F : 0.0F;
      for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
          if (x >= 320 && (x + y) % 5 != 0) continue;  // dots: no more than four neighbours
          sfm.mean(y, x) = (x < hole ? 2.0F + wild(x / 32) : behind) +
                           static_cast<float>(random.gaussian(static_cast<double>(kSigma)));
        }
      }
      points.collect(sfm, sensor);
      others.observe(points, sfm.mean, sensor);
    }
    return others;
  }
};

TEST_F(OtherSurfacesTest, BeginsWithPriors) {
  const OtherSurfaces others;
  EXPECT_DOUBLE_EQ(others.whereSeen({0, 0}), 0.5 * 0.3);
  EXPECT_DOUBLE_EQ(others.whereSeen({24, 0}), 0.5 * 0.3 / 13.0);
  EXPECT_DOUBLE_EQ(others.whereSeen({0, 24}), 0.5 * 0.3 / 13.0);
  EXPECT_LT(others.whereSeen({24, 24}), 1e-3);
  EXPECT_FLOAT_EQ(others.inHole(0.01F, 2.0F), 0.01F);
}

TEST_F(OtherSurfacesTest, LearnsByNeighboursHowFarOtherSurfacesAre) {
  // Stripes at 2.5 m before a wall at 2 m are off by a fifth of their depth.
  const OtherSurfaces others = learn(0.4, 0.1);
  EXPECT_NEAR(others.whereSeen({4, 4}), 0.4 * 0.2 * 0.2, 0.005);
  EXPECT_GT(others.whereSeen({24, 15}),
            10.0 * others.whereSeen({24, 24}));  // in a stripe, few wide ones agree
  EXPECT_LT(learn(0.0, 0.0).whereSeen({24, 24}), 1e-5);
}

TEST_F(OtherSurfacesTest, APrioriStepsOutlastFramesThatShowNone) {
  const OtherSurfaces begin, later = learn(0.0, 0.0);
  EXPECT_LT(later.whereSeen({4, 4}), 0.5 * begin.whereSeen({4, 4}));
  EXPECT_GT(later.whereSeen({4, 4}), 0.01 * begin.whereSeen({4, 4}));
}

/// By the side of a stripe, 19 of the wide neighbours agree. That says nothing of pixels with 18 or 20.
TEST_F(OtherSurfacesTest, EachNumberOfNeighboursIsLearnedByItself) {
  const OtherSurfaces stripes = learn(0.0, 0.1), wall = learn(0.0, 0.0);
  EXPECT_GT(stripes.whereSeen({24, 19}), 100.0 * wall.whereSeen({24, 19}));
  for (const int wide : {18, 20})
    EXPECT_NEAR(stripes.whereSeen({24, wide}), wall.whereSeen({24, wide}), 1e-6) << wide;
}

TEST_F(OtherSurfacesTest, InAHoleDepthThatTheSensorWouldSeeIsRatherOfASurfaceBehind) {
  const OtherSurfaces others = learn(0.0, 0.0, 560, 4.0F);
  EXPECT_GT(others.inHole(0.001F, 2.0F), 0.01F);
  EXPECT_LT(others.inHole(0.9F, 2.0F), 1.0F);                        // Z² at most
  EXPECT_NEAR(others.inHole(0.001F, 4.0F), 0.001F, 0.0002F);         // the sensor would see none of it
  EXPECT_NEAR(learn(0.0, 0.0).inHole(0.001F, 2.0F), 0.001F, 1e-9F);  // there is no hole
}

TEST_F(OtherSurfacesTest, AHoleThatIsNoFartherThanTheRestSaysNothing) {
  EXPECT_NEAR(learn(0.0, 0.0, 560, 2.0F).inHole(0.001F, 2.0F), 0.001F, 0.0001F);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
