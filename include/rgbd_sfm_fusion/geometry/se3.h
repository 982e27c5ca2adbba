// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace rgbd_sfm_fusion {

/// Translation (x y z) first, rotation (rx ry rz) second, as in ROS's pose covariances.
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Rigid transform. Variables are named `T_target_source`: p_target = T_target_source * p_source.
class SE3 {
 public:
  /// Identity.
  SE3() = default;

  /// @param rotation its length need not be 1, but must not be 0
  SE3(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation)
      : rotation_(toUnit(rotation)), translation_(translation) {}

  /// The transform reached after unit time at the constant twist `xi` = (v, ω).
  static SE3 exp(const Vector6& xi);

  /// The twist xi for which exp(xi) is this transform, with a rotation angle in [0, π].
  Vector6 log() const;

  SE3 inverse() const {
    const Eigen::Quaterniond inverse_rotation = rotation_.conjugate();
    return {inverse_rotation, -(inverse_rotation * translation_)};
  }

  /// Ad with exp(Ad ξ) * T = T * exp(ξ): carries twists and their covariances from source to target axes.
  Matrix6 adjoint() const;

  const Eigen::Quaterniond& rotation() const { return rotation_; }
  const Eigen::Vector3d& translation() const { return translation_; }
  Eigen::Matrix3d rotationMatrix() const { return rotation_.toRotationMatrix(); }

  friend SE3 operator*(const SE3& a, const SE3& b) {
    return {a.rotation_ * b.rotation_, a.rotation_ * b.translation_ + a.translation_};
  }
  friend Eigen::Vector3d operator*(const SE3& a, const Eigen::Vector3d& point) {
    return a.rotation_ * point + a.translation_;
  }

 private:
  /// Does not touch a quaternion whose length is 1 up to rounding. So poses come out of a message with the
  /// bits that went in; dividing by a length of 1 + 1e-16 would change them.
  static Eigen::Quaterniond toUnit(const Eigen::Quaterniond& q) {
    constexpr double kRounding = 1e-14;
    return std::abs(q.squaredNorm() - 1.0) <= kRounding ? q : q.normalized();
  }

  Eigen::Quaterniond rotation_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation_ = Eigen::Vector3d::Zero();
};

/// The matrix [v]x with [v]x w = v x w.
Eigen::Matrix3d skewSymmetric(const Eigen::Vector3d& v);

}  // namespace rgbd_sfm_fusion
