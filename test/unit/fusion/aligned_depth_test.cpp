// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/sfm_state.h"

#include <gtest/gtest.h>

#include <cmath>

#include "unit/fusion/depth_images.h"

namespace rgbd_sfm_fusion {
namespace {

using test::kNone;

GaussianDepth align(const GaussianDepth& sfm, const SfmState& state, double limit = 0.5) {
  PinholeCamera camera = test::smallCamera();
  camera.height = sfm.mean.rows;
  SfmPoints points;
  points.collect(sfm, {sfm, {}, {}, {}});
  align(state, camera, limit, 1.0, &points);
  GaussianDepth depth{sfm.mean.clone(), sfm.variance.clone()};
  points.dropAndWrite(cv::Mat_<std::uint8_t>(sfm.mean.size(), std::uint8_t{0}), &depth);
  return depth;
}

SfmState someState() {
  SfmState state;
  state.alpha = 2.5;
  state.offset = 0.02;
  state.tilt = {0.03, -0.01};
  Eigen::Matrix4d root;
  root << 0.02, 0.0, 0.0, 0.0, -0.015, 0.004, 0.0, 0.0, 0.001, -0.002, 0.006, 0.0, 0.003, 0.001, 0.0, 0.008;
  state.covariance = root * root.transpose();
  return state;
}

/// Z = 1/ρ, and σ_ρ² is the sum of what the state and SfM say: at corners and in the middle, near and far.
TEST(AlignedDepth, IsTheStateAtEachPixelAndCarriesItsCovariance) {
  const PinholeCamera camera = test::smallCamera();
  SfmState state = someState();
  state.field_variance = 0.004 * 0.004;
  for (const float mu : {0.2f, 0.8f, 4.0f}) {
    const GaussianDepth sfm =
        test::withRelativeSigma(test::constant({camera.width, camera.height}, mu), 0.05f);
    const GaussianDepth depth = align(sfm, state, 10.0);
    for (const cv::Point p : {cv::Point(0, 0), cv::Point(80, 59), cv::Point(159, 119), cv::Point(0, 119)}) {
      const Eigen::Vector3d ray = camera.backProject(p.x, p.y, 1.0);
      const double sfm_rho = 1.0 / static_cast<double>(mu),
                   rho = state.inverseDepth(sfm_rho, ray.x(), ray.y());
      const double own = 0.05 * sfm_rho / state.alpha;
      const double variance = own * own + state.variance(sfm_rho, ray.x(), ray.y()) + state.field_variance;
      EXPECT_NEAR(static_cast<double>(depth.mean(p)) * rho, 1.0, 1e-5) << mu << p;
      EXPECT_NEAR(static_cast<double>(depth.variance(p)) * std::pow(rho, 4) / variance, 1.0, 1e-3) << mu << p;
    }
  }
}

TEST(AlignedDepth, OfTheScaleAloneIsAProduct) {
  SfmState state;
  state.alpha = 2.5;
  state.covariance(0, 0) = 0.01 * 0.01;
  const GaussianDepth depth = align({DepthImage(3, 4, 0.8f), cv::Mat_<float>(3, 4, 0.01f)}, state);
  EXPECT_EQ(depth.mean(1, 1), 2.5f * 0.8f);
  EXPECT_FLOAT_EQ(depth.variance(1, 1), 6.25f * 0.01f + 4.0f * 1e-4f);
}

TEST(AlignedDepth, ThatIsNoGaussianIsNone) {
  GaussianDepth sfm{DepthImage(1, 5, 1.0f), cv::Mat_<float>(1, 5, 1e-4f)};
  sfm.variance(0, 1) = 0.3f;  // σ is more than half of the depth
  sfm.mean(0, 2) = sfm.variance(0, 2) = kNone;
  sfm.mean(0, 3) = 1000.0f;  // beyond infinity
  SfmState state;
  state.alpha = 1.0;
  state.offset = -0.01;
  const GaussianDepth depth = align(sfm, state);
  EXPECT_TRUE(test::isConsistent(depth));
  EXPECT_GT(depth.mean(0, 0), 1.0f);
  for (const int x : {1, 2, 3}) EXPECT_TRUE(std::isnan(depth.mean(0, x))) << x;
  EXPECT_EQ(sfm.mean(0, 0), 1.0f) << "what it is made from stays";
}

TEST(AlignedDepth, SpreadsWhatSfmStates) {
  SfmPoints points;
  points.collect({DepthImage(1, 1, 2.0f), cv::Mat_<float>(1, 1, 0.01f)},
                 {{DepthImage(1, 1, kNone), {}}, {}, {}, {}});
  SfmState state;
  state.alpha = 1.0;
  PinholeCamera camera = test::smallCamera();
  camera.height = 1;
  align(state, camera, 0.5, 4.0, &points);
  EXPECT_EQ(points.sfm[0], 2.0f);
  EXPECT_FLOAT_EQ(points.sfm_variance[0], 0.04f);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
