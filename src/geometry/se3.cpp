// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/geometry/se3.h"

#include <cmath>

namespace rgbd_sfm_fusion {
namespace {

// Below this angle [rad] the closed forms lose digits, and two terms of their series are exact to 1e-16.
constexpr double kSmallAngle = 1e-4;

/// V of the closed form exp(v, ω) = (R, V v): the mean of the rotations passed through.
Eigen::Matrix3d leftJacobian(const Eigen::Vector3d& omega) {
  const double angle_squared = omega.squaredNorm();
  const double angle = std::sqrt(angle_squared);
  double a = 0.5 - angle_squared / 24.0;         // (1 - cos θ) / θ²
  double b = 1.0 / 6.0 - angle_squared / 120.0;  // (θ - sin θ) / θ³
  if (angle > kSmallAngle) {
    a = (1.0 - std::cos(angle)) / angle_squared;
    b = (angle - std::sin(angle)) / (angle_squared * angle);
  }
  const Eigen::Matrix3d omega_hat = skewSymmetric(omega);
  return Eigen::Matrix3d::Identity() + a * omega_hat + b * omega_hat * omega_hat;
}

Eigen::Vector3d rotationVector(const Eigen::Quaterniond& rotation) {
  // Of the two quaternions of a rotation, the one with w >= 0 has the angle in [0, π].
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d axis_sine = sign * rotation.vec();  // axis * sin(θ / 2)
  const double cosine = sign * rotation.w();
  const double sine = axis_sine.norm();
  if (sine < kSmallAngle) return axis_sine * (2.0 / cosine) * (1.0 - sine * sine / (3.0 * cosine * cosine));
  return axis_sine * (2.0 * std::atan2(sine, cosine) / sine);
}

}  // namespace

Eigen::Matrix3d skewSymmetric(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

SE3 SE3::exp(const Vector6& xi) {
  const Eigen::Vector3d omega = xi.tail<3>();
  const double half = 0.5 * omega.norm();
  const double sine_over_angle =
      half > 0.5 * kSmallAngle ? 0.5 * std::sin(half) / half : 0.5 - half * half / 12.0;
  Eigen::Quaterniond rotation;
  rotation.w() = std::cos(half);
  rotation.vec() = sine_over_angle * omega;
  return {rotation, leftJacobian(omega) * xi.head<3>()};
}

Vector6 SE3::log() const {
  Vector6 xi;
  xi.tail<3>() = rotationVector(rotation_);
  xi.head<3>() = leftJacobian(xi.tail<3>()).inverse() * translation_;
  return xi;
}

Matrix6 SE3::adjoint() const {
  const Eigen::Matrix3d R = rotationMatrix();
  Matrix6 adjoint;
  adjoint << R, skewSymmetric(translation_) * R, Eigen::Matrix3d::Zero(), R;
  return adjoint;
}

}  // namespace rgbd_sfm_fusion
