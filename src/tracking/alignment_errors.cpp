// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/alignment_errors.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "rgbd_sfm_fusion/tracking/strip_scatter.h"

namespace rgbd_sfm_fusion {

double noiseOf(const NormalEquations& equations, double noise, double huber) {
  const double beyond = std::erfc(huber * M_SQRT1_2);
  const double density = std::exp(-0.5 * huber * huber) / std::sqrt(2.0 * M_PI);
  const double expected = 1.0 - beyond - 2.0 * huber * density + huber * huber * beyond;
  return noise * std::sqrt(equations.bounded / std::max(equations.in_view, 1.0) / expected);
}

Matrix6 stepCovariance(const NormalEquations& equations) {
  NormalEquations::Matrix scatter = equations.H;
  const auto gradient = [](const NormalEquations::Part& strip) { return strip.g; };
  addScatter(equations.strips, gradient, scatter);
  const Eigen::LDLT<NormalEquations::Matrix> ldlt(equations.H);
  const NormalEquations::Matrix half = ldlt.solve(scatter);
  const NormalEquations::Matrix covariance = ldlt.solve(half.transpose());
  return covariance.topLeftCorner<6, 6>();
}

Matrix6 stepByReadout(const NormalEquations& equations) {
  return equations.H.ldlt().solve(gradientByReadout<8>(equations.strips)).topRows<6>();
}

}  // namespace rgbd_sfm_fusion
