// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/geometry/se3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace rgbd_sfm_fusion {
namespace {

/// Twists with the awkward rotation angles: none, tiny, either side of the series' limit, large, nearly π.
std::vector<Vector6> twists() {
  std::vector<Vector6> result;
  const Eigen::Vector3d axes[] = {{1, 0, 0}, {0, -1, 0}, Eigen::Vector3d(1, -2, 3).normalized()};
  for (const double angle : {0.0, 1e-12, 0.99e-4, 1.01e-4, 2.1e-4, 0.3, 2.0, M_PI - 1e-3, M_PI - 1e-7}) {
    for (const Eigen::Vector3d& axis : axes) {
      Vector6 xi;
      xi << 0.7, -1e-3, 12.0, angle * axis;
      result.push_back(xi);
    }
  }
  return result;
}

Eigen::Matrix4d matrix(const SE3& T) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = T.rotationMatrix();
  m.topRightCorner<3, 1>() = T.translation();
  return m;
}

TEST(SE3, LogInvertsExp) {
  for (const Vector6& xi : twists()) EXPECT_LT((SE3::exp(xi).log() - xi).norm(), 1e-8) << xi.transpose();
}

TEST(SE3, ExpIsTheLimitOfManySmallSteps) {
  for (const Vector6& xi : twists()) {
    const int steps = 1 << 20;
    Eigen::Matrix4d power = Eigen::Matrix4d::Identity();
    power.topLeftCorner<3, 3>() += skewSymmetric(xi.tail<3>()) / steps;
    power.topRightCorner<3, 1>() = xi.head<3>() / steps;
    for (int squarings = 0; squarings < 20; ++squarings) power = (power * power).eval();
    EXPECT_LT((matrix(SE3::exp(xi)) - power).norm(), 2e-4) << xi.transpose();
  }
}

TEST(SE3, MadeFromItsPartsKeepsEveryBit) {
  for (const Vector6& a : twists()) {
    for (const Vector6& b : twists()) {
      const SE3 T = SE3::exp(a) * SE3::exp(b).inverse();
      EXPECT_EQ(SE3(T.rotation(), T.translation()).rotation().coeffs(), T.rotation().coeffs());
    }
  }
}

TEST(SE3, InverseUndoes) {
  for (const Vector6& xi : twists()) {
    const SE3 T = SE3::exp(xi);
    EXPECT_LT((matrix(T * T.inverse()) - Eigen::Matrix4d::Identity()).norm(), 1e-12);
  }
}

TEST(SE3, ProductAndPointFollowTheMatrices) {
  for (const Vector6& a : twists()) {
    for (const Vector6& b : twists()) {
      const SE3 A = SE3::exp(a), B = SE3::exp(b);
      EXPECT_LT((matrix(A * B) - matrix(A) * matrix(B)).norm(), 1e-12);
      const Eigen::Vector3d p(0.1, -5.0, 3.0);
      EXPECT_LT((A * (B * p) - (A * B) * p).norm(), 1e-12);
    }
  }
}

TEST(SE3, AdjointCarriesTwistsToTheTarget) {
  for (const Vector6& a : twists()) {
    const SE3 T = SE3::exp(a);
    Vector6 xi;
    xi << 0.01, 0.02, -0.03, 0.1, -0.2, 0.05;
    EXPECT_LT((matrix(SE3::exp(T.adjoint() * xi) * T) - matrix(T * SE3::exp(xi))).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
