// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/reprojection.h"

#include <gtest/gtest.h>

#include "unit/fusion/depth_images.h"

namespace rgbd_sfm_fusion {
namespace {

using test::kNone;

SE3 pose(double x, double y, double z, double rx, double ry, double rz) {
  Vector6 xi;
  xi << x, y, z, rx, ry, rz;
  return SE3::exp(xi);
}

/// About a third of the pixels have depth, along the lines of a wavy pattern.
GaussianDepth semiDense(const PinholeCamera& camera) {
  const Eigen::Vector3d n = Eigen::Vector3d(0.2, -0.1, 1.0).normalized();
  GaussianDepth depth = test::withRelativeSigma(test::plane(camera, n, 2.0), 0.02f);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      if (std::sin(0.5 * x + 2.0 * std::sin(0.1 * y)) < 0.3) depth.mean(y, x) = depth.variance(y, x) = kNone;
    }
  }
  return depth;
}

ReprojectionOptions pointsOnly() {
  ReprojectionOptions options;
  options.close_gaps = false;
  options.pose_covariance = false;
  options.lateral_sigma = 0.0f;
  return options;
}

int count(const DepthImage& depth) {
  return static_cast<int>(std::count_if(depth.begin(), depth.end(), [](float z) { return z > 0.0f; }));
}

TEST(Reprojection, IdentityReturnsTheSameBits) {
  const PinholeCamera camera = test::smallCamera();
  const GaussianDepth keyframe = semiDense(camera);
  for (const Splat splat : {Splat::kNearest, Splat::kBilinear}) {
    ReprojectionOptions options;
    options.splat = splat;
    const GaussianDepth frame = reproject(keyframe, camera, SE3(), Matrix6::Zero(), options);
    EXPECT_TRUE(test::sameBits(frame.mean, keyframe.mean));
    EXPECT_TRUE(test::sameBits(frame.variance, keyframe.variance));
  }
}

/// The same image as a part of a larger one, so that other values stand between its rows.
cv::Mat_<float> withRowStep(const cv::Mat_<float>& image) {
  cv::Mat_<float> larger(image.rows, image.cols + 24, -7.0f);
  image.copyTo(larger.colRange(8, 8 + image.cols));
  return larger.colRange(8, 8 + image.cols);
}

TEST(Reprojection, ImagesMayHaveSomethingBetweenTheirRows) {
  const PinholeCamera camera = test::smallCamera();
  const GaussianDepth keyframe = semiDense(camera);
  const GaussianDepth apart{withRowStep(keyframe.mean), withRowStep(keyframe.variance)};
  ASSERT_FALSE(apart.mean.isContinuous());
  const SE3 T = pose(0.05, -0.02, -0.3, 0.02, 0.03, 0.1);
  for (const Splat splat : {Splat::kNearest, Splat::kBilinear}) {
    ReprojectionOptions options;
    options.splat = splat;
    const GaussianDepth expected = reproject(keyframe, camera, T, Matrix6::Zero(), options);
    EXPECT_GT(count(expected.mean), 1000);
    const GaussianDepth frame = reproject(apart, camera, T, Matrix6::Zero(), options);
    EXPECT_TRUE(test::sameBits(frame.mean, expected.mean));
    EXPECT_TRUE(test::sameBits(frame.variance, expected.variance));
    const GaussianDepth buffer{withRowStep(keyframe.mean), withRowStep(keyframe.variance)};
    const GaussianDepth elsewhere = reproject(keyframe, camera, T, Matrix6::Zero(), options, buffer);
    EXPECT_TRUE(test::sameBits(elsewhere.mean, expected.mean));
    EXPECT_TRUE(test::sameBits(elsewhere.variance, expected.variance));
  }
}

TEST(Reprojection, NearIdentityChangesNothingButDigits) {
  const PinholeCamera camera = test::smallCamera();
  const GaussianDepth keyframe = semiDense(camera);
  const GaussianDepth frame =
      reproject(keyframe, camera, pose(1e-9, 0, 0, 0, 1e-9, 0), Matrix6::Zero(), pointsOnly());
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      ASSERT_EQ(std::isnan(frame.mean(y, x)), std::isnan(keyframe.mean(y, x)));
      if (std::isnan(frame.mean(y, x))) continue;
      ASSERT_NEAR(frame.mean(y, x), keyframe.mean(y, x), 1e-5f);
    }
  }
}

// The convention: p_frame = T_frame_keyframe * p_keyframe, in both directions.
TEST(Reprojection, APointGoesWhereTheTransformTakesIt) {
  const PinholeCamera camera = test::smallCamera();
  for (const SE3& T :
       {pose(0.3, -0.1, 0.2, 0.05, -0.1, 0.2), pose(0.3, -0.1, 0.2, 0.05, -0.1, 0.2).inverse(),
        pose(0, 0, 0, 0, 0, 3.14),
        SE3(Eigen::Quaterniond(Eigen::AngleAxisd(M_PI - 1e-3, Eigen::Vector3d::UnitY())), {0, 0, 6})}) {
    int seen = 0;
    for (int y = 1; y < camera.height; y += 9) {
      for (int x = 1; x < camera.width; x += 9) {
        GaussianDepth keyframe{DepthImage(camera.height, camera.width, kNone),
                               cv::Mat_<float>(camera.height, camera.width, kNone)};
        keyframe.mean(y, x) = 3.0f;
        keyframe.variance(y, x) = 0.01f;
        const Eigen::Vector3d point = T * camera.backProject(x, y, 3.0);
        const Eigen::Vector2d pixel = camera.project(point);
        const cv::Point rounded(static_cast<int>(std::lround(pixel.x())),
                                static_cast<int>(std::lround(pixel.y())));
        const bool visible = point.z() > 0 && cv::Rect(0, 0, camera.width, camera.height).contains(rounded);
        const GaussianDepth frame = reproject(keyframe, camera, T, Matrix6::Zero(), pointsOnly());
        ASSERT_EQ(count(frame.mean), visible ? 1 : 0);
        if (!visible) continue;
        ++seen;
        ASSERT_NEAR(frame.mean(rounded), point.z(), 1e-5);
        const Eigen::Vector3d nudged = T * camera.backProject(x, y, 3.001);
        const double gain = (nudged.z() - point.z()) / 0.001;
        ASSERT_NEAR(frame.variance(rounded), gain * gain * 0.01, 1e-5);
      }
    }
    EXPECT_GT(seen, 20);
  }
}

TEST(Reprojection, ThereAndBackIsIdentityWhereVisibleInBoth) {
  const PinholeCamera camera = test::smallCamera();
  const GaussianDepth keyframe = semiDense(camera);
  for (const double angle : {0.0, 1e-9, 0.05, 0.3}) {
    const SE3 T = pose(0.05, -0.02, 0.08, 0.0, 0.0, angle);
    const GaussianDepth there = reproject(keyframe, camera, T, Matrix6::Zero(), pointsOnly());
    const GaussianDepth back = reproject(there, camera, T.inverse(), Matrix6::Zero(), pointsOnly());
    int compared = 0;
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        if (std::isnan(back.mean(y, x)) || std::isnan(keyframe.mean(y, x))) continue;
        ++compared;
        ASSERT_NEAR(back.mean(y, x) / keyframe.mean(y, x), 1.0f, 0.006f) << x << " " << y;  // rounded twice
      }
    }
    EXPECT_GT(compared, count(keyframe.mean) / 2) << angle;
  }
}

TEST(Reprojection, DepthAndTranslationShareTheirUnit) {
  const PinholeCamera camera = test::smallCamera();
  const GaussianDepth keyframe = semiDense(camera);
  const SE3 T = pose(0.1, 0.05, -0.2, 0.03, -0.02, 0.1);
  Matrix6 covariance = Matrix6::Identity() * 1e-5;
  const GaussianDepth reference = reproject(keyframe, camera, T, covariance, ReprojectionOptions());
  for (const float unit : {0.125f, 8.0f}) {  // powers of two scale without rounding
    GaussianDepth other{keyframe.mean.clone(), keyframe.variance.clone()};
    for (float& mean : other.mean) mean *= unit;
    for (float& variance : other.variance) variance *= unit * unit;
    Matrix6 scaled_covariance = covariance;
    scaled_covariance.topRows<3>() *= static_cast<double>(unit);
    scaled_covariance.leftCols<3>() *= static_cast<double>(unit);
    const GaussianDepth frame =
        reproject(other, camera, SE3(T.rotation(), T.translation() * static_cast<double>(unit)),
                  scaled_covariance, ReprojectionOptions());
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        if (std::isnan(reference.mean(y, x))) {
          ASSERT_TRUE(std::isnan(frame.mean(y, x)));
          continue;
        }
        ASSERT_FLOAT_EQ(frame.mean(y, x), unit * reference.mean(y, x));
        ASSERT_FLOAT_EQ(frame.variance(y, x), unit * unit * reference.variance(y, x));
      }
    }
  }
}

TEST(Reprojection, PoseCovarianceIsThatOfPerturbedPoses) {
  const PinholeCamera camera = test::smallCamera();
  const SE3 T = pose(0.1, 0.05, -0.2, 0.03, -0.02, 0.1);
  Matrix6 root = Matrix6::Random() * 0.02;  // any covariance, with correlations
  const Matrix6 covariance = root * root.transpose();
  GaussianDepth keyframe{DepthImage(camera.height, camera.width, kNone),
                         cv::Mat_<float>(camera.height, camera.width, kNone)};
  for (const cv::Point p : {cv::Point(40, 30), cv::Point(120, 90), cv::Point(80, 60)}) {
    keyframe.mean(p) = 2.5f;
    keyframe.variance(p) = 1e-12f;
  }
  ReprojectionOptions options = pointsOnly();
  options.pose_covariance = true;
  const GaussianDepth frame = reproject(keyframe, camera, T, covariance, options);
  int compared = 0;
  for (const cv::Point p : {cv::Point(40, 30), cv::Point(120, 90), cv::Point(80, 60)}) {
    const Eigen::Vector3d point = T * camera.backProject(p.x, p.y, 2.5);
    Eigen::Matrix<double, 1, 6> jacobian;
    for (int i = 0; i < 6; ++i) {
      const Vector6 step = 1e-6 * Vector6::Unit(i);
      jacobian(i) = ((SE3::exp(step) * point).z() - (SE3::exp(-step) * point).z()) / 2e-6;
    }
    const double expected = jacobian * covariance * jacobian.transpose();
    const Eigen::Vector2d pixel = camera.project(point);
    const float variance =
        frame.variance(static_cast<int>(std::lround(pixel.y())), static_cast<int>(std::lround(pixel.x())));
    // The Jacobian is taken at the pixel's centre, half a pixel off at most.
    EXPECT_NEAR(static_cast<double>(variance) / expected, 1.0, 0.05);
    ++compared;
  }
  EXPECT_EQ(compared, 3);
}

// Compares with Z' of the point at a pixel's centre, differentiated by every uncertain quantity.
TEST(Reprojection, VarianceIsThatOfNumericDifferences) {
  const PinholeCamera camera = test::smallCamera();
  const Matrix6 root = Matrix6::Random() * 0.01;
  const Matrix6 covariance = root * root.transpose();
  ReprojectionOptions options = pointsOnly();
  options.pose_covariance = true;
  constexpr float kSigma = 0.02f;
  int compared = 0;
  for (const SE3& T : {pose(0.1, 0.05, -0.2, 0.03, -0.02, 0.1), pose(0.3, 0.0, 0.1, 0.25, 0.0, 0.0),
                       pose(0.0, -0.2, 0.3, 0.0, -0.3, 0.0), pose(0.0, 0.0, 0.0, 0.1, 0.1, 1.5)}) {
    for (const cv::Point origin : {cv::Point(50, 40), cv::Point(110, 80), cv::Point(80, 60)}) {
      GaussianDepth keyframe{DepthImage(camera.height, camera.width, kNone),
                             cv::Mat_<float>(camera.height, camera.width, kNone)};
      keyframe.mean(origin) = 2.5f;
      keyframe.variance(origin) = kSigma * kSigma;
      const auto z_of = [&](double mu) { return (T * camera.backProject(origin.x, origin.y, mu)).z(); };
      const Eigen::Vector2d pixel = camera.project(T * camera.backProject(origin.x, origin.y, 2.5));
      const cv::Point centre(static_cast<int>(std::lround(pixel.x())),
                             static_cast<int>(std::lround(pixel.y())));
      if (!cv::Rect(0, 0, camera.width, camera.height).contains(centre)) continue;
      const Eigen::Vector3d seen = camera.backProject(centre.x, centre.y, z_of(2.5));
      Eigen::Matrix<double, 1, 6> by_pose;
      for (int i = 0; i < 6; ++i) {
        const Vector6 step = 1e-5 * Vector6::Unit(i);
        by_pose(i) = ((SE3::exp(step) * seen).z() - (SE3::exp(-step) * seen).z()) / 2e-5;
      }
      const double by_depth = (z_of(2.501) - z_of(2.499)) / 0.002;
      const double expected = by_depth * by_depth * static_cast<double>(kSigma * kSigma) +
                              by_pose * covariance * by_pose.transpose();
      const GaussianDepth frame = reproject(keyframe, camera, T, covariance, options);
      EXPECT_NEAR(static_cast<double>(frame.variance(centre)) / expected, 1.0, 2e-3) << T.log().transpose();
      ++compared;
    }
  }
  EXPECT_GE(compared, 8);
}

class ReprojectionOfTwoSurfaces : public ::testing::TestWithParam<Splat> {};

TEST_P(ReprojectionOfTwoSurfaces, TheNearOneHidesTheFarOne) {
  const PinholeCamera camera = test::smallCamera();
  DepthImage depth(camera.height, camera.width, 4.0f);
  depth(cv::Range(40, 80), cv::Range(40, 80)).setTo(1.0);
  ReprojectionOptions options;
  options.splat = GetParam();
  // The camera moves towards the scene. The near square grows by a third, so its points no longer fill it.
  const GaussianDepth frame = reproject(test::withRelativeSigma(depth, 0.02f), camera,
                                        pose(0.02, 0, -0.25, 0, 0, 0), Matrix6::Zero(), options);
  EXPECT_TRUE(test::isConsistent(frame));
  int near = 0, of = 0;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d there = pose(-0.02, 0, 0.25, 0, 0, 0) * camera.backProject(x, y, 0.75);
      const Eigen::Vector2d origin = camera.project(there);
      if (!cv::Rect2d(41.0, 41.0, 37.0, 37.0).contains({origin.x(), origin.y()})) continue;
      ++of;
      near += frame.mean(y, x) < 1.0f ? 1 : 0;
      ASSERT_FALSE(frame.mean(y, x) > 1.0f) << "the far wall shines through at " << x << ", " << y;
    }
  }
  EXPECT_GT(near, of * 97 / 100);
}

INSTANTIATE_TEST_SUITE_P(Splats, ReprojectionOfTwoSurfaces,
                         ::testing::Values(Splat::kNearest, Splat::kBilinear));

TEST(Reprojection, GapsAreClosedOnOneSurfaceFromWhatTheKeyframeHas) {
  const PinholeCamera camera = test::smallCamera();
  const DepthImage depth = test::constant({camera.width, camera.height}, 1.0f);
  const SE3 closer = pose(0, 0, -0.25, 0, 0, 0);
  ReprojectionOptions open = pointsOnly(), closed = pointsOnly();
  closed.close_gaps = true;
  const GaussianDepth keyframe = test::withRelativeSigma(depth, 0.02f);
  EXPECT_LT(count(reproject(keyframe, camera, closer, Matrix6::Zero(), open).mean), 12000);
  EXPECT_GT(count(reproject(keyframe, camera, closer, Matrix6::Zero(), closed).mean), 18800);  // of 19200
  // Depth that the keyframe lacks is not made up.
  GaussianDepth lines{keyframe.mean.clone(), keyframe.variance.clone()};
  for (int x = 1; x < camera.width; x += 2) {
    lines.mean.col(x).setTo(static_cast<double>(kNone));
    lines.variance.col(x).setTo(static_cast<double>(kNone));
  }
  const SE3 shift = pose(4.0 / camera.fx, 0, 0, 0, 0, 0);
  const GaussianDepth moved = reproject(lines, camera, shift, Matrix6::Zero(), closed);
  EXPECT_EQ(count(moved.mean), (camera.width - 4) / 2 * camera.height);
}

TEST(Reprojection, AFarPointBetweenNearOnesStaysWhereTheKeyframeHasIt) {
  const PinholeCamera camera = test::smallCamera();
  DepthImage depth = test::constant({camera.width, camera.height}, 1.0f);
  depth.col(80).setTo(1.4);  // a slit
  const SE3 tiny = pose(1e-4, 0, 0, 0, 0, 0);
  const GaussianDepth frame =
      reproject(test::withRelativeSigma(depth, 0.02f), camera, tiny, Matrix6::Zero(), ReprojectionOptions());
  for (int y = 1; y < camera.height - 1; ++y) EXPECT_NEAR(frame.mean(y, 80), 1.4f, 1e-5f);
}

TEST(Reprojection, OfOneSurfacesPointsTheMoreCertainOneIsKept) {
  const PinholeCamera camera{16, 16, 16.0, 16.0, 8.0, 8.0};
  GaussianDepth keyframe{DepthImage(16, 16, kNone), cv::Mat_<float>(16, 16, kNone)};
  keyframe.mean(8, 8) = keyframe.mean(8, 9) = 1.0f;
  keyframe.mean(8, 9) = 1.02f;
  for (const bool first : {true, false}) {
    keyframe.variance(8, 8) = first ? 1e-4f : 1e-2f;
    keyframe.variance(8, 9) = first ? 1e-2f : 1e-4f;
    // From twice the distance on, both points fall on one pixel.
    const GaussianDepth frame =
        reproject(keyframe, camera, pose(0, 0, 2.0, 0, 0, 0), Matrix6::Zero(), pointsOnly());
    ASSERT_EQ(count(frame.mean), 1);
    EXPECT_FLOAT_EQ(frame.mean(8, 8), first ? 3.0f : 3.02f);
    EXPECT_FLOAT_EQ(frame.variance(8, 8), 1e-4f);
  }
}

TEST(Reprojection, NothingComesFromBehindOrFromNothing) {
  const PinholeCamera camera = test::smallCamera();
  const GaussianDepth keyframe = semiDense(camera);
  const SE3 turned = pose(0, 0, 0, 0, M_PI, 0), beyond = pose(0, 0, -50, 0, 0, 0);
  for (const SE3& T : {turned, beyond})
    EXPECT_EQ(count(reproject(keyframe, camera, T, Matrix6::Zero(), ReprojectionOptions()).mean), 0);
  const GaussianDepth none{DepthImage(camera.height, camera.width, kNone),
                           cv::Mat_<float>(camera.height, camera.width, kNone)};
  EXPECT_EQ(
      count(reproject(none, camera, pose(0.1, 0, 0, 0, 0, 0), Matrix6::Zero(), ReprojectionOptions()).mean),
      0);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
