// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/depth_residuals.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rgbd_sfm_fusion/tracking/direct_alignment.h"
#include "rgbd_sfm_fusion/tracking/tracking_candidates.h"
#include "synthetic_views.h"

namespace rgbd_sfm_fusion {
namespace {

const SE3 kStep = motion(0.02, -0.01, 0.015, 0.01, -0.02, 0.015);  // of the camera between two frames

class DepthResiduals : public testing::Test {
 protected:
  DepthCells cells(const DepthImage& depth) const {
    DepthCells cells;
    cells.compute(depth, scene_.camera(), DepthNoiseModel());
    return cells;
  }

  PlaneScene scene_{smallCamera()};
  DepthCells keyframe_ = cells(scene_.depthImage(SE3()));
};

TEST_F(DepthResiduals, ACellHasTheInverseDepthOfItsCentre) {
  const PinholeCamera& camera = keyframe_.camera();
  ASSERT_EQ(keyframe_.inverseDepth().size(), cv::Size(20, 15));
  for (const cv::Point cell : {cv::Point(0, 0), cv::Point(19, 14), cv::Point(7, 3)}) {
    const Eigen::Vector3d ray((cell.x - camera.cx) / camera.fx, (cell.y - camera.cy) / camera.fy, 1.0);
    const Eigen::Vector2d pixel = scene_.camera().project(ray);
    EXPECT_NEAR(keyframe_.inverseDepth()(cell), 1.0 / scene_.depth(SE3(), pixel.x(), pixel.y()), 1e-6)
        << cell;
  }
}

TEST_F(DepthResiduals, ACellThatIsLeftOutHasNone) {
  cv::Mat_<std::uint8_t> squares(15, 20, std::uint8_t{0});
  squares(7, 3) = 1;
  DepthCells result = cells(scene_.depthImage(SE3()));
  result.leaveOut({});
  EXPECT_TRUE(std::isfinite(result.inverseDepth()(7, 3)));
  result.leaveOut(squares);
  EXPECT_TRUE(std::isnan(result.inverseDepth()(7, 3)));
  EXPECT_TRUE(std::isfinite(result.inverseDepth()(7, 4)));
}

TEST_F(DepthResiduals, ACellAcrossAStepOrAHoleOrOutOfRangeHasNone) {
  DepthImage depth = scene_.depthImage(SE3());
  depth(40, 40) = std::numeric_limits<float>::quiet_NaN();
  depth.colRange(100, 104) -= 0.5F;
  depth(cv::Rect(160, 160, 16, 16)) *= 4.0F;
  const DepthCells result = cells(depth);
  EXPECT_TRUE(std::isnan(result.inverseDepth()(2, 2)));
  EXPECT_TRUE(std::isnan(result.inverseDepth()(5, 6)));
  EXPECT_TRUE(std::isnan(result.inverseDepth()(10, 10)));
  EXPECT_TRUE(std::isfinite(result.inverseDepth()(3, 2)));
}

TEST_F(DepthResiduals, VanishAtTheTrueMotion) {
  const DepthCells frame = cells(scene_.depthImage(kStep));
  DepthPair pair{&keyframe_, &frame};
  const PoseEquations at_truth = depthEquations(pair, kStep, SE3());
  const PoseEquations elsewhere = depthEquations(pair, SE3(), SE3());
  EXPECT_GT(elsewhere.cost, 10.0);
  EXPECT_LT(at_truth.cost, 1e-3 * elsewhere.cost);
  EXPECT_LT(at_truth.g.norm(), 1e-2 * elsewhere.g.norm());
}

TEST_F(DepthResiduals, GradientIsThatOfTheCost) {
  const DepthCells frame = cells(scene_.depthImage(kStep));
  const SE3 T = kStep * motion(0.004, 0.003, 0.004, 0.002, -0.003, 0.001);
  const DepthPair pair{&keyframe_, &frame};
  const auto cost = [&](const Vector6& delta) {
    return depthEquations(pair, T * SE3::exp(delta).inverse(), SE3()).cost;
  };
  const Vector6 g = depthEquations(pair, T, SE3()).g;
  for (int i = 0; i < 6; ++i) {
    const Vector6 delta = 1e-3 * Vector6::Unit(i);
    EXPECT_NEAR(-(cost(delta) - cost(-delta)) / 2e-3, g(i), 0.05 * g.norm()) << i;
  }
}

TEST_F(DepthResiduals, JacobianOfEachPartOfTheImageIsThatOfNumericDifferences) {
  const SE3 roll = motion(0.02, -0.03, 0.04, 0.03, -0.02, 0.4);
  const SE3 beside = roll * motion(0.002, 0.001, 0.003, 0.001, -0.002, 0.001);
  for (const cv::Rect part :
       {cv::Rect(80, 64, 64, 48), cv::Rect(160, 112, 48, 64), cv::Rect(96, 128, 64, 48)}) {
    DepthImage depth(scene_.depthImage(roll).size(), std::numeric_limits<float>::quiet_NaN());
    scene_.depthImage(roll)(part).copyTo(depth(part));
    const DepthCells frame = cells(depth);
    const DepthPair pair{&keyframe_, &frame};
    const auto cost = [&](const SE3& T, const Vector6& delta) {
      return depthEquations(pair, T * SE3::exp(delta).inverse(), SE3()).cost;
    };
    const Vector6 g = depthEquations(pair, beside, SE3()).g;
    const Matrix6 H = depthEquations(pair, roll, SE3()).H;
    for (int i = 0; i < 6; ++i) {
      const Vector6 little = 2e-4 * Vector6::Unit(i), more = 10.0 * little;
      EXPECT_NEAR((cost(beside, -little) - cost(beside, little)) / 4e-4, g(i), 0.02 * g.norm()) << i << part;
      // Where residuals vanish, their Jacobian alone makes the cost's curvature.
      const double curvature = (cost(roll, more) + cost(roll, -more) - 2.0 * cost(roll, 0.0 * more)) / 4e-6;
      EXPECT_NEAR(curvature, H(i, i), 0.15 * H(i, i) + 1e-3 * H.trace()) << i << part;
    }
  }
}

TEST_F(DepthResiduals, WhatIsOfAnotherSurfaceDoesNotCount) {
  DepthImage depth = scene_.depthImage(kStep);
  depth(cv::Rect(64, 64, 96, 80)) -= 0.4F;
  const DepthCells frame = cells(depth), of_plane_alone = cells(scene_.depthImage(kStep));
  const double scale = depthEquations({&keyframe_, &of_plane_alone}, SE3(), SE3()).g.norm();
  EXPECT_LT(depthEquations({&keyframe_, &frame}, kStep, SE3()).g.norm(), 1e-2 * scale);
}

TEST_F(DepthResiduals, DepthMayBeOlderThanColour) {
  // The depth is half a step older than the colour image at kStep. The keyframe is the last frame.
  const SE3 T_depth_world = SE3::exp(0.5 * kStep.log());
  const DepthCells frame = cells(scene_.depthImage(T_depth_world));
  DepthPair pair{&keyframe_, &frame};
  const double unaware = depthEquations(pair, kStep, kStep).cost;
  pair.age = 0.5;
  EXPECT_LT(depthEquations(pair, kStep, kStep).cost, 1e-3 * unaware);

  // If the age is uncertain, residuals that depend on it count less.
  const double trusting = depthEquations(pair, kStep, kStep).H.trace();
  pair.age_sigma = 0.5;
  EXPECT_LT(depthEquations(pair, kStep, kStep).H.trace(), 0.5 * trusting);
  EXPECT_NEAR(depthEquations(pair, SE3(), SE3()).H.trace(),
              depthEquations({&keyframe_, &frame}, SE3(), SE3()).H.trace(),
              1e-6 * trusting);  // at rest, age does not matter
}

TEST_F(DepthResiduals, TellATurnFromAMoveSideways) {
  constexpr int kLevels = 4;
  TrackingOptions options;
  options.pyramid_levels = kLevels;
  InverseDepthImage depth;
  depth.mean = 1.0F / scene_.depthImage(SE3());
  depth.variance.create(depth.mean.size());
  depth.variance.setTo(1e-4);
  ImagePyramid keyframe_image, image;
  keyframe_image.build(scene_.frame(0, SE3(), 4.0, 1).grey, kLevels);
  image.build(scene_.frame(1, kStep, 4.0, 2).grey, kLevels);
  TrackingCandidates candidates;
  candidates.setKeyframe(keyframe_image, cameraPyramid(scene_.camera(), kLevels), {options.min_gradient},
                         options.finest_level);
  TrackingReference reference;
  candidates.collect(depth, ReadoutMotion(), {}, {}, reference);
  const DepthCells frame = cells(scene_.depthImage(kStep));
  const auto turn = [&](const DepthPair& pair) {
    const AlignmentResult result = align({reference, image, options, {}, {}, pair}, {SE3()});
    EXPECT_LT((result.T_frame_keyframe * kStep.inverse()).log().norm(), 3e-3);
    return result.covariance(4, 4);
  };
  EXPECT_LT(turn({&keyframe_, &frame, 0.0, 0.0, 2e-4F}), 0.3 * turn({}));
}

}  // namespace
}  // namespace rgbd_sfm_fusion
