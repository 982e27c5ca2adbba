// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace rgbd_sfm_fusion {

/// Adds the scatter of the gradients of whole strips of an image, adjacent strips together (White 1980; Newey
/// and West 1987). Residuals of neighbours are alike, as neighbours share the errors of depths, of the
/// shutter and of moving objects; independent pixels alone would scatter far less.
/// @param gradient_of  gives a strip's gradient at the solution
template <class Strips, class GradientOf, class Matrix>
void addScatter(const Strips& strips, const GradientOf& gradient_of, Matrix& scatter) {
  auto last = gradient_of(strips.front());
  bool is_first = true;
  for (const auto& strip : strips) {
    const auto gradient = gradient_of(strip);
    scatter += gradient * gradient.transpose();
    if (!is_first) scatter += 0.5 * (last * gradient.transpose() + gradient * last.transpose());
    last = gradient;
    is_first = false;
  }
}

/// Derivative of the gradient by an error of the motion during the readout, in the keyframe's axes: each
/// strip is off by its share of the error.
/// @tparam N  number of parameters that the gradient has, the pose's six first
template <int N, class Strips>
Eigen::Matrix<double, N, 6> gradientByReadout(const Strips& strips) {
  Eigen::Matrix<double, N, 6> sum = Eigen::Matrix<double, N, 6>::Zero();
  for (const auto& strip : strips) sum += strip.share * strip.H.template topLeftCorner<N, 6>();
  return sum;
}

}  // namespace rgbd_sfm_fusion
