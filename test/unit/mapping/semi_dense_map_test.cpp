// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/semi_dense_map.h"

#include <gtest/gtest.h>

#include "rgbd_sfm_fusion/mapping/propagation.h"
#include "rgbd_sfm_fusion/mapping/regularisation.h"
#include "synthetic_views.h"

namespace rgbd_sfm_fusion {
namespace {

const cv::Size kSize(320, 240);
constexpr int kPixel = 100 * 320 + 150;

SemiDenseMap emptyMap() {
  SemiDenseMap map;
  map.create(kSize);
  map.clear();
  return map;
}

void put(SemiDenseMap& map, int row, int column, float mean, float sigma) {
  map.estimate.mean(row, column) = mean;
  map.estimate.variance(row, column) = sigma * sigma;
  map.observations(row, column) = 3;
}

TEST(SemiDenseMapUpdate, IsTheProductOfGaussians) {
  for (const float ratio : {1e-3F, 1.0F, 1e3F}) {
    SemiDenseMap map = emptyMap();
    const float first = 1e-4F, second = ratio * 1e-4F;
    update({{kPixel, true, 0.5F, first}, {kPixel, true, 0.505F, second}}, map);
    const float expected = (0.5F * second + 0.505F * first) / (first + second);
    EXPECT_NEAR(map.estimate.mean[0][kPixel], expected, 1e-6F);
    EXPECT_NEAR(map.estimate.variance[0][kPixel], first * second / (first + second), 1e-10F);
    EXPECT_EQ(map.observations[0][kPixel], 2);
  }
}

TEST(SemiDenseMapUpdate, ContradictionsDoNotMoveAnEstimateButEndIt) {
  SemiDenseMap map = emptyMap();
  update({{kPixel, true, 0.5F, 1e-4F}}, map);
  for (int contradictions = 0; map.observations[0][kPixel] > 0; ++contradictions) {
    ASSERT_LT(contradictions, 10);
    EXPECT_EQ(map.estimate.mean[0][kPixel], 0.5F);
    update({{kPixel, true, 0.9F, 1e-4F}}, map);
  }
  EXPECT_EQ(map.estimate.mean[0][kPixel], 0.0F);
  EXPECT_TRUE(std::isinf(map.estimate.variance[0][kPixel]));
}

TEST(SemiDenseMapUpdate, AlsoAnEstimateOfVeryManyObservationsEnds) {
  SemiDenseMap map = emptyMap();
  for (int i = 0; i < 300; ++i) update({{kPixel, true, 0.5F, 1e-4F}}, map);
  for (int i = 0; i < 300; ++i) update({{kPixel, false, 0.0F, 1e-4F}}, map);
  EXPECT_EQ(map.observations[0][kPixel], 0);
}

TEST(SemiDenseMapUpdate, AFailedSearchStartsNothing) {
  SemiDenseMap map = emptyMap();
  update({{kPixel, false, 0.0F, 0.0F}}, map);
  EXPECT_EQ(map.observations[0][kPixel], 0);
}

/// Pixels that are observed a hundred times each, with errors of `spread` times the stated sigma.
SemiDenseMap observed(double spread) {
  SemiDenseMap map = emptyMap();
  cv::RNG random(7);
  for (int row = 100; row < 105; ++row) {
    for (int column = 100; column < 105; ++column) {
      for (int i = 0; i < 100; ++i) {
        const auto value = static_cast<float>(0.5 + random.gaussian(spread * 0.01));
        update({{row * kSize.width + column, true, value, 1e-4F}}, map);
      }
    }
  }
  return map;
}

TEST(ObservationScatter, IsThatOfTheObservations) {
  for (const double spread : {0.3, 1.0}) {
    const SemiDenseMap map = observed(spread);
    const double mean = cv::mean(map.scatter(cv::Rect(100, 100, 5, 5)))[0];
    // Of a hundred, next to which the value at the start is worth two.
    EXPECT_NEAR(mean, 0.98 * spread * spread + 0.02, 0.05 * spread * spread);
  }
}

TEST(ObservationScatter, GrowsWithContradictionsAndIsOneAtFirst) {
  SemiDenseMap map = emptyMap();
  update({{kPixel, true, 0.5F, 1e-4F}}, map);
  EXPECT_EQ(map.scatter[0][kPixel], 1.0F);
  update({{kPixel, true, 0.5F, 1e-4F}}, map);
  const float agreeing = map.scatter[0][kPixel];
  EXPECT_LT(agreeing, 1.0F);
  update({{kPixel, false, 0.0F, 0.0F}}, map);
  EXPECT_GT(map.scatter[0][kPixel], agreeing);
  map.clearPixel(kPixel);
  update({{kPixel, true, 0.5F, 1e-4F}}, map);
  EXPECT_EQ(map.scatter[0][kPixel], 1.0F) << "of the new estimate";
}

StereoCandidates everyPixel() {
  cv::Mat_<float> ramp(kSize);
  for (int v = 0; v < ramp.rows; ++v) {
    for (int u = 0; u < ramp.cols; ++u) ramp(v, u) = static_cast<float>(u);
  }
  StereoCandidates candidates;
  candidates.collect(ramp, cv::Rect({}, kSize), 1.0F);
  return candidates;
}

class PropagationTest : public testing::Test {
 protected:
  PropagationTest() : from_(emptyMap()), to_(emptyMap()), grey_(kSize, 100) {}
  static InverseDepthWarp warp(const SE3& T_to_from) { return {smallCamera(), T_to_from, {}, {}}; }
  void run(const SE3& T_to_from) {
    cv::Mat_<float> image;
    grey_.convertTo(image, CV_32F);
    run(T_to_from, image, {});
  }
  void run(const SE3& T_to_from, const cv::Mat_<float>& to_image, const Brightness& brightness) {
    Propagation(kSize).run({grey_, to_image, cv::Rect({}, kSize), warp(T_to_from), brightness}, from_,
                           everyPixel(), {}, to_);
  }

  SemiDenseMap from_, to_;
  GreyImage grey_;
};

TEST_F(PropagationTest, ByTheIdentityKeepsPlaceAndDepth) {
  put(from_, 100, 150, 0.5F, 0.01F);
  run(SE3());
  EXPECT_FLOAT_EQ(to_.estimate.mean(100, 150), 0.5F);
  EXPECT_GE(to_.estimate.variance(100, 150), 1e-4F);
  EXPECT_EQ(cv::countNonZero(to_.observations), 1);
}

TEST_F(PropagationTest, FollowsTheProjection) {
  put(from_, 100, 150, 0.5F, 0.01F);
  const SE3 T = motion(0.1, 0.05, -0.3, 0.02, 0.03, 0.05);
  run(T);
  const Eigen::Vector3d point = T * smallCamera().backProject(150, 100, 2.0);
  const Eigen::Vector2d pixel = smallCamera().project(point);
  const int column = static_cast<int>(std::lround(pixel.x())), row = static_cast<int>(std::lround(pixel.y()));
  EXPECT_NEAR(to_.estimate.mean(row, column), 1.0 / point.z(), 1e-5);
  // The sigma of depth stays the same along a ray that hardly turns: 2 % of 2 m.
  EXPECT_NEAR(std::sqrt(static_cast<double>(to_.estimate.variance(row, column))) * point.z() * point.z(),
              0.04, 0.02);
}

TEST_F(PropagationTest, TheNearerSurfaceHidesTheOther) {
  for (const bool near_first : {true, false}) {
    from_ = emptyMap();
    // Both estimates land on one pixel after a sideways motion: disparities differ by the distance between
    // them.
    put(from_, 100, near_first ? 124 : 137, near_first ? 1.0F : 0.5F, 0.001F);
    put(from_, 100, near_first ? 137 : 124, near_first ? 0.5F : 1.0F, 0.001F);
    run(motion(0.1, 0, 0));
    EXPECT_NEAR(to_.estimate.mean(100, 150), 1.0F, 1e-5F);
    EXPECT_EQ(cv::countNonZero(to_.observations), 1);
  }
}

TEST_F(PropagationTest, NoiseDoesNotDrawASurfaceNearer) {
  constexpr float kRho = 0.5F, kSigma = 0.05F * kRho;
  cv::RNG random(1);
  for (int row = 0; row < kSize.height; ++row) {
    for (int column = 0; column < kSize.width; ++column)
      put(from_, row, column, kRho + static_cast<float>(random.gaussian(static_cast<double>(kSigma))),
          kSigma);
  }
  run(motion(0.0, 0.0, 1.0));  // a step back: several estimates come to one pixel
  ASSERT_GT(cv::countNonZero(to_.estimate.mean), 20000);
  EXPECT_NEAR(cv::mean(to_.estimate.mean, to_.estimate.mean > 0.0F)[0], 1.0 / 3.0, 0.0005);
}

TEST_F(PropagationTest, LeavesPixelsOfOtherBrightnessBehind) {
  put(from_, 100, 150, 0.5F, 0.01F);
  cv::Mat_<float> other(kSize, 200.0F);
  run(SE3(), other, {});
  EXPECT_EQ(cv::countNonZero(to_.observations), 0);
  run(SE3(), other, {0.5, 150.0});
  EXPECT_EQ(cv::countNonZero(to_.observations), 1);
}

TEST_F(PropagationTest, TakesASharpEdgeAcrossHalfAPixel) {
  cv::Mat_<float> moved(kSize);
  for (int v = 0; v < kSize.height; ++v) {
    for (int u = 0; u < kSize.width; ++u) {
      grey_(v, u) = u < 150 ? 50 : 130;
      moved(v, u) = u < 150 ? 50.0F : (u == 150 ? 90.0F : 130.0F);
    }
  }
  for (int v = 90; v < 110; ++v) put(from_, v, 150, 0.5F, 0.001F);
  run(motion(0.49 * 2.0 / smallCamera().fx, 0, 0), moved, {});
  EXPECT_EQ(cv::countNonZero(to_.observations), 20);
}

/// As a surface comes nearer, its pixels move apart, and rounding leaves rows and columns of gaps.
TEST_F(PropagationTest, LeavesNoGapsInASurfaceThatComesNearer) {
  for (int v = 90; v < 150; ++v) {
    for (int u = 130; u < 190; ++u) put(from_, v, u, 0.5F, 0.001F);
  }
  run(motion(0, 0, -0.3));
  const cv::Rect inside(135, 95, 50, 50);
  EXPECT_EQ(cv::countNonZero(to_.observations(inside)), inside.area());
}

TEST_F(PropagationTest, GivesNothingToAPixelThatHadNothing) {
  for (int v = 90; v < 150; ++v) {
    for (int u = 130; u < 190; ++u) {
      if (u % 8 != 0) put(from_, v, u, 0.5F, 0.001F);
    }
  }
  run(SE3());
  EXPECT_EQ(cv::countNonZero(to_.observations), cv::countNonZero(from_.observations));
}

class Regularisation : public testing::Test {
 protected:
  Regularisation() : map_(emptyMap()) { regulariser_.setCandidates(everyPixel(), kSize); }
  SemiDenseMap map_;
  Regulariser regulariser_;
};

TEST_F(Regularisation, AveragesTheScatterOfNeighboursThatAgree) {
  for (int row = 90; row < 110; ++row) {
    for (int column = 90; column < 110; ++column) {
      const bool front = column >= 100;
      put(map_, row, column, front ? 1.0F : 0.5F, 0.01F);
      map_.scatter(row, column) = front ? 4.0F : (row % 4 < 2 ? 0.1F : 0.3F);
    }
  }
  regulariser_.apply(map_);
  EXPECT_NEAR(regulariser_.scatter()(100, 95), 0.2F, 0.05F);
  EXPECT_NEAR(regulariser_.scatter()(100, 99), 0.2F, 0.1F);  // not the scatter of the surface beside it
  EXPECT_NEAR(regulariser_.scatter()(100, 100), 4.0F, 1e-5F);
}

TEST_F(Regularisation, DoesNotMixTwoSurfaces) {
  for (int v = 90; v < 110; ++v) {
    for (int u = 140; u < 160; ++u) put(map_, v, u, u < 150 ? 0.5F : 0.8F, 0.01F);
  }
  regulariser_.apply(map_);
  for (int u = 142; u < 158; ++u)
    EXPECT_NEAR(regulariser_.smoothed().mean(100, u), u < 150 ? 0.5F : 0.8F, 1e-6F);
}

TEST_F(Regularisation, ReducesNoiseButNotTheStatedVariance) {
  cv::RNG random(3);
  for (int v = 50; v < 150; ++v) {
    for (int u = 50; u < 150; ++u) put(map_, v, u, 0.5F + static_cast<float>(random.gaussian(0.01)), 0.01F);
  }
  regulariser_.apply(map_);
  double squares = 0.0;
  for (int v = 60; v < 140; ++v) {
    for (int u = 60; u < 140; ++u) {
      squares += std::pow(static_cast<double>(regulariser_.smoothed().mean(v, u)) - 0.5, 2);
      EXPECT_EQ(regulariser_.smoothed().variance(v, u), map_.estimate.variance(v, u));
    }
  }
  EXPECT_LT(std::sqrt(squares / (80 * 80)), 0.005);
}

/// Published depth is averaged twice. Its variance must match its scatter, for good pixels and for poor ones
/// among them.
TEST_F(Regularisation, AveragesWidelyWithTheVarianceOfTheMean) {
  for (int v = 50; v < 150; ++v) {
    for (int u = 50; u < 150; ++u) put(map_, v, u, 0.5F, (u + v) % 5 == 0 ? 0.04F : 0.01F);
  }
  regulariser_.apply(map_);
  InverseDepthImage wide;
  regulariser_.smoothWidely(regulariser_.smoothed(), wide);
  for (int u = 70; u < 80; ++u) {
    EXPECT_NEAR(wide.mean(100, u), 0.5F, 1e-6F);
    // Of 13 pixels, one in four or five has a sixteenth of the weight, and 4.5 count as one.
    EXPECT_NEAR(wide.variance(100, u), 4.5F * 1e-4F / 10.5F, 1.2e-5F);
  }
  EXPECT_TRUE(std::isinf(wide.variance(30, 30)));
  EXPECT_EQ(wide.mean(30, 30), 0.0F);
}

TEST_F(Regularisation, AnOutlierHasNoSupportAndAGapGetsAPrior) {
  for (int v = 90; v < 110; ++v) {
    for (int u = 140; u < 160; ++u) put(map_, v, u, 0.5F, 0.01F);
  }
  put(map_, 100, 150, 0.9F, 0.01F);
  map_.clearPixel(95 * kSize.width + 145);
  regulariser_.apply(map_);
  EXPECT_EQ(regulariser_.support()(100, 150), 0);
  EXPECT_GE(regulariser_.support()(104, 152), 8);
  EXPECT_NEAR(regulariser_.smoothed().mean(95, 145), 0.5F, 1e-5F);
  EXPECT_GT(regulariser_.smoothed().variance(95, 145), 1e-4F);
  EXPECT_EQ(regulariser_.smoothed().mean(30, 30), 0.0F);
}

TEST_F(Regularisation, NeighboursThatAgreeWithEachOtherContradictAnOutlier) {
  for (int v = 90; v < 110; ++v) {
    for (int u = 140; u < 160; ++u) put(map_, v, u, 0.5F, 0.01F);
    put(map_, v, 155, 0.9F, 0.01F);  // a thin thing in front
  }
  const auto at = [](int v, int u) { return v * kSize.width + u; };
  put(map_, 100, 150, 0.9F, 0.01F);  // a wrong match
  put(map_, 30, 30, 0.5F, 0.01F);    // alone
  put(map_, 100, 161, 0.9F, 0.01F);  // beside the surface
  for (int v = 48; v < 53; ++v) {    // nothing but wrong matches
    for (int u = 48; u < 53; ++u) put(map_, v, u, 0.1F * static_cast<float>((3 * v + 5 * u) % 11 + 1), 0.01F);
  }
  regulariser_.apply(map_);
  EXPECT_TRUE(regulariser_.isContradicted(map_, at(100, 150)));
  EXPECT_FALSE(regulariser_.isContradicted(map_, at(100, 151)));
  EXPECT_FALSE(regulariser_.isContradicted(map_, at(100, 155)));
  EXPECT_FALSE(regulariser_.isContradicted(map_, at(30, 30)));
  EXPECT_FALSE(regulariser_.isContradicted(map_, at(100, 161)));
  EXPECT_FALSE(regulariser_.isContradicted(map_, at(50, 50)));
}

}  // namespace
}  // namespace rgbd_sfm_fusion
