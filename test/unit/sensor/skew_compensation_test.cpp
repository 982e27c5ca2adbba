// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/sensor/skew_compensation.h"

#include <gtest/gtest.h>

#include "unit/fusion/depth_images.h"

namespace rgbd_sfm_fusion {
namespace {

SE3 pose(double x, double y, double z, double rx, double ry, double rz) {
  Vector6 xi;
  xi << x, y, z, rx, ry, rz;
  return SE3::exp(xi);
}

double distance(const SE3& a, const SE3& b) {
  return (a.inverse() * b).log().norm();
}

TEST(MotionSinceDepth, IsExactAtConstantVelocity) {
  const SE3 start = pose(1.0, -2.0, 0.5, 0.3, -1.0, 2.0);
  Vector6 velocity;  // [1/s] in the axes of the body
  velocity << 0.3, -0.2, 0.5, 0.7, -0.4, 0.2;
  const auto at = [&](Stamp stamp) { return start * SE3::exp(velocity * toSeconds(stamp)); };
  const StampedPose previous{0, at(0)}, current{33'000'000, at(33'000'000)};
  for (const Stamp depth : {-20'000'000, 0, 23'000'000, 32'999'999, 33'000'000, 60'000'000}) {
    const SE3 expected = at(current.stamp).inverse() * at(depth);  // T_colour_depth
    EXPECT_LT(distance(motionSinceDepth(previous, current, depth), expected), 1e-9) << depth;
  }
}

TEST(MotionSinceDepth, IsNoneWhereTheVelocityIsUnknown) {
  const StampedPose current{10'000'000'000, pose(0.1, 0, 0, 0, 0.1, 0)};
  const SE3 none;
  EXPECT_EQ(distance(motionSinceDepth({}, current, 9'990'000'000), none), 0.0);
  for (const Stamp previous : {Stamp{9'000'000'000}, Stamp{10'000'000'000}, Stamp{10'100'000'000}})
    EXPECT_EQ(distance(motionSinceDepth({previous, none}, current, 9'990'000'000), none), 0.0) << previous;
  EXPECT_EQ(distance(motionSinceDepth({9'970'000'000, none}, current, 9'000'000'000), none), 0.0);
}

TEST(SkewCompensation, IdentityReturnsTheSameBits) {
  DepthImage depth = test::plane(test::smallCamera(), {0.2, 0.1, 1.0}, 2.0);
  depth(3, 4) = test::kNone;
  EXPECT_TRUE(test::sameBits(compensateSkew(depth, test::smallCamera(), SE3()), depth));
}

TEST(SkewCompensation, APlaneIsThePlaneSeenFromThere) {
  const PinholeCamera camera = test::smallCamera();
  const Eigen::Vector3d n = Eigen::Vector3d(0.2, -0.1, 1.0).normalized();
  const DepthImage depth = test::plane(camera, n, 2.0);
  for (const SE3& T : {pose(0.03, 0, 0, 0, 0, 0), pose(0, 0, -0.15, 0, 0, 0), pose(0, 0, 0.1, 0, 0, 0.05),
                       pose(0.02, -0.01, 0.05, 0.02, -0.03, 0.01)}) {
    const DepthImage moved = compensateSkew(depth, camera, T);
    const Eigen::Vector3d n_there = T.rotationMatrix() * n;
    const DepthImage expected = test::plane(camera, n_there, 2.0 + n_there.dot(T.translation()));
    for (int y = 20; y < camera.height - 20; ++y) {
      for (int x = 25; x < camera.width - 25; ++x)  // no cracks inside; right to half a pixel of slope
        ASSERT_NEAR(moved(y, x), expected(y, x), 0.004f) << x << " " << y;
    }
  }
}

TEST(SkewCompensation, HolesStayHoles) {
  const PinholeCamera camera = test::smallCamera();
  DepthImage depth = test::constant({camera.width, camera.height}, 1.0f);
  for (int y = 5; y < camera.height; y += 10) {
    for (int x = 5; x < camera.width; x += 10) depth(y, x) = test::kNone;  // holes of one pixel, like cracks
  }
  const double dx = 3.0 / camera.fx;
  const DepthImage moved = compensateSkew(depth, camera, pose(dx, 0, 0, 0, 0, 0));
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 3; x < camera.width; ++x)
      ASSERT_EQ(std::isnan(moved(y, x)), std::isnan(depth(y, x - 3))) << x << " " << y;
  }
}

TEST(SkewCompensation, TheNearerSurfaceHidesTheOther) {
  const PinholeCamera camera = test::smallCamera();
  DepthImage depth = test::constant({camera.width, camera.height}, 4.0f);
  depth(cv::Range(40, 80), cv::Range(40, 80)).setTo(1.0);
  const DepthImage moved = compensateSkew(depth, camera, pose(8.0 / camera.fx, 0, 0, 0, 0, 0));
  for (int y = 41; y < 79; ++y) {
    for (int x = 48; x < 88; ++x) ASSERT_EQ(moved(y, x), 1.0f) << x << " " << y;
    EXPECT_EQ(moved(y, 95), 4.0f);
    EXPECT_TRUE(std::isnan(moved(y, 45))) << "uncovered background is unknown";
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
