// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/principal_point_estimation.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "rgbd_sfm_fusion/tracking/strip_scatter.h"

namespace rgbd_sfm_fusion {
namespace {

// Principal points of three Kinects are 8 px (r.m.s., each way) from what their driver says (TUM RGB-D
// benchmark).
constexpr double kPriorSigma = 0.015;  // of the focal length
constexpr double kTiltSigma = 0.01;    // of a keyframe's inverse depths, per ray

using Nuisances = Eigen::Matrix<double, CalibrationEquations::kParameters - 2, 1>;
constexpr int kNuisances = Nuisances::RowsAtCompileTime;

/// The parameters without the principal point.
template <class Vector>
Nuisances nuisances(const Vector& v) {
  Nuisances result;
  result << v.template head<CalibrationEquations::kPrincipalPoint>(), v.template tail<2>();
  return result;
}

template <class Vector>
Eigen::Vector2d principalPoint(const Vector& v) {
  return v.template segment<2>(CalibrationEquations::kPrincipalPoint);
}

}  // namespace

PrincipalPointEstimator::PrincipalPointEstimator(const PinholeCamera& camera)
    : belief_(kPriorSigma * camera.fx) {}

void PrincipalPointEstimator::observe(const CalibrationEquations& equations, Stamp keyframe,
                                      const Eigen::Vector2d& correction, double readout_sigma) {
  CalibrationEquations::Matrix H = equations.H;
  H(CalibrationEquations::kReadout, CalibrationEquations::kReadout) +=
      1.0 / std::max(readout_sigma * readout_sigma, 1e-12);  // 0: it is known
  H.diagonal().tail<2>().array() += 1.0 / (kTiltSigma * kTiltSigma);
  Eigen::Matrix<double, kNuisances, kNuisances> of_nuisances;
  Eigen::Matrix<double, kNuisances, 2> mixed;
  for (int j = 0, i = 0; i < CalibrationEquations::kParameters; ++i) {
    if (i == CalibrationEquations::kPrincipalPoint || i == CalibrationEquations::kPrincipalPoint + 1)
      continue;
    of_nuisances.col(j) = nuisances(H.col(i));
    mixed.row(j++) = principalPoint(H.col(i)).transpose();
  }
  // Without pose, brightness, readout and tilt, which are what they are.
  const Eigen::Matrix<double, kNuisances, 2> by_nuisances = of_nuisances.ldlt().solve(mixed);
  const Eigen::Matrix2d information =
      H.block<2, 2>(CalibrationEquations::kPrincipalPoint, CalibrationEquations::kPrincipalPoint) -
      by_nuisances.transpose() * mixed;
  const auto alone = [&](const CalibrationEquations::Vector& gradient) -> Eigen::Vector2d {
    return principalPoint(gradient) - by_nuisances.transpose() * nuisances(gradient);
  };
  if (!isPositive(information)) return;
  step_by_principal_point_ = -by_nuisances.topRows<6>();
  const Eigen::Vector2d measured = information.inverse() * alone(equations.g);
  const CalibrationEquations::Vector step = H.ldlt().solve(equations.g);
  Eigen::Matrix2d scatter = information;
  const auto gradient = [&](const CalibrationEquations::Part& strip) -> Eigen::Vector2d {
    return alone(strip.g - strip.H * step);
  };
  addScatter(equations.strips, gradient, scatter);
  belief_.observe(information * scatter.inverse() * information, measured, keyframe, correction);
}

}  // namespace rgbd_sfm_fusion
