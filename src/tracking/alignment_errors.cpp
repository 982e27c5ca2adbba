// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/alignment_errors.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "rgbd_sfm_fusion/tracking/strip_scatter.h"

namespace rgbd_sfm_fusion {
namespace {

/// S⁻¹ H. The gradient's covariance would be H if errors were independent, and is S. So H S⁻¹ H is the
/// information that there is, and (S⁻¹ H)ᵀ g the gradient that belongs to it.
/// @param sum  of the strips
template <int N, class Sum, class Strips>
Eigen::Matrix<double, N, N> weights(const Sum& sum, const Strips& strips) {
  using Vector = Eigen::Matrix<double, N, 1>;
  // A direction may have no depth at all.
  const Vector step = sum.H.completeOrthogonalDecomposition().solve(sum.g);
  Eigen::Matrix<double, N, N> covariance = sum.H;
  addScatter(
      strips, [&](const auto& strip) -> Vector { return strip.g - strip.H * step; }, covariance);
  return covariance.completeOrthogonalDecomposition().solve(sum.H);
}

}  // namespace

double noiseOf(const NormalEquations& equations, double noise, double huber) {
  const double beyond = std::erfc(huber * M_SQRT1_2);
  const double density = std::exp(-0.5 * huber * huber) / std::sqrt(2.0 * M_PI);
  const double expected = 1.0 - beyond - 2.0 * huber * density + huber * huber * beyond;
  return equations.judged > 0.0 ? noise * std::sqrt(equations.bounded / equations.judged / expected) : noise;
}

StepEstimate estimateStep(const NormalEquations& equations) {
  NormalEquations::Part brightness;
  for (const NormalEquations::Part& strip : equations.strips) {
    brightness.H += strip.H;
    brightness.g += strip.g;
  }
  const NormalEquations::Matrix of_brightness = weights<8>(brightness, equations.strips);
  const Matrix6 of_depth = weights<6>(equations.depth, equations.depth.strips);
  NormalEquations::Matrix information = brightness.H * of_brightness;
  NormalEquations::Vector gradient = of_brightness.transpose() * brightness.g;
  const Matrix6 depth_information = equations.depth.H * of_depth;
  const Vector6 depth_gradient = of_depth.transpose() * equations.depth.g;
  information.topLeftCorner<6, 6>() += depth_information;
  gradient.head<6>() += depth_gradient;
  const NormalEquations::Matrix covariance = information.ldlt().solve(NormalEquations::Matrix::Identity());
  const Eigen::Matrix<double, 8, 6> by_readout =
      covariance * of_brightness.transpose() * gradientByReadout<8>(equations.strips);
  const NormalEquations::Vector step = covariance * gradient;
  return {step,
          covariance.topLeftCorner<6, 6>(),
          by_readout.topRows<6>(),
          static_cast<double>(of_brightness.rows()) / of_brightness.trace(),
          depth_information,
          depth_gradient - depth_information * step.head<6>()};
}

}  // namespace rgbd_sfm_fusion
