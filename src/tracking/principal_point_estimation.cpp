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
// Keyframes of recordings contradict each other by 1.3 to 2.8 times the sigma that strips give (rendered ones
// by 1.1): what is left of the lens's distortion looks the same in all of an image. So much is assumed at
// first, and counts as much as a keyframe.
constexpr double kInflation = 2.5;
// So much of what a keyframe says is doubted. Depths that were found with a wrong principal point hide some
// of its error; and what is left of the lens's distortion looks like a principal point that is off: without a
// doubt, that of a Kinect passed for one. So no keyframe alone makes it clear.
constexpr double kDoubt = 0.3;
const double kClear = std::log(50.0);  // log odds

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

bool isPositive(const Eigen::Matrix2d& information) {
  return information.allFinite() && information(0, 0) > 0.0 && information.determinant() > 0.0;
}

}  // namespace

void PrincipalPointEstimator::Evidence::add(const Eigen::Matrix2d& J, const Eigen::Vector2d& m) {
  information += J;
  pull += J * m;
  square += m.dot(J * m);
  ++count;
}

Eigen::Vector2d PrincipalPointEstimator::Evidence::mean() const {
  return information.inverse() * pull;
}

double PrincipalPointEstimator::Evidence::scatter() const {
  return std::max(square - pull.dot(mean()), 0.0) / (2.0 * (count - 1));
}

PrincipalPointEstimator::PrincipalPointEstimator(const PinholeCamera& camera)
    : prior_information_(1.0 / (kPriorSigma * camera.fx * kPriorSigma * camera.fx)), belief_(belief()) {}

void PrincipalPointEstimator::observe(const CalibrationEquations& equations, Stamp keyframe,
                                      const Eigen::Vector2d& correction, double readout_sigma) {
  if (keyframe != keyframe_) {
    keyframes_ = withLatest();
    frames_ = Evidence();
    most_ = 0.0;
    correction_ = correction;
    keyframe_ = keyframe;
  }
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
  const Eigen::Matrix2d honest = information * scatter.inverse() * information;
  if (!isPositive(honest) || !measured.allFinite()) return;
  frames_.add(honest, measured);
  most_ = std::max(most_, honest.trace());
  belief_ = belief();
}

PrincipalPointEstimator::Evidence PrincipalPointEstimator::withLatest() const {
  Evidence keyframes = keyframes_;
  if (!isPositive(frames_.information)) return keyframes;
  const Eigen::Vector2d mean = frames_.mean();
  Eigen::Matrix2d covariance = (frames_.information.trace() / most_) * frames_.information.inverse();
  covariance.diagonal() += (kDoubt * mean).cwiseAbs2();
  keyframes.add(covariance.inverse(), correction_ + mean);
  return keyframes;
}

PrincipalPointEstimator::Belief PrincipalPointEstimator::belief() const {
  const Evidence keyframes = withLatest();
  // How far keyframes contradict each other is learned, too.
  const double more = std::max(keyframes.count - 1, 0);
  const double scatter = more > 0.0 ? keyframes.scatter() : 0.0;
  const double inflation = (kInflation * kInflation + more * scatter) / (1.0 + more);
  const Eigen::Matrix2d information = keyframes.information / inflation;
  const Eigen::Vector2d pull = keyframes.pull / inflation;
  Belief belief;
  belief.covariance = (information + prior_information_ * Eigen::Matrix2d::Identity()).inverse();
  belief.mean = belief.covariance * pull;
  const double spread = (Eigen::Matrix2d::Identity() + information / prior_information_).determinant();
  belief.log_odds = 0.5 * (pull.dot(belief.mean) - std::log(spread));
  return belief;
}

Eigen::Vector2d PrincipalPointEstimator::correction() const {
  return belief_.log_odds > kClear ? belief_.mean : Eigen::Vector2d::Zero();
}

Eigen::Vector2d PrincipalPointEstimator::sigma() const {
  const double off = 1.0 / (1.0 + std::exp(-belief_.log_odds));
  const Eigen::Vector2d reported = correction(), spread = belief_.covariance.diagonal();
  return (off * (spread + (belief_.mean - reported).cwiseAbs2()) + (1.0 - off) * reported.cwiseAbs2())
      .cwiseSqrt();
}

}  // namespace rgbd_sfm_fusion
