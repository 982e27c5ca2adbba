// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/readout_estimation.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "rgbd_sfm_fusion/tracking/strip_scatter.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kStationary = 0.00073;  // [s] sigma that remains, so that the filter forgets in 30 keyframes

constexpr int kReadout = CalibrationEquations::kReadout;  // the last of the parameters that are used here
using Vector9 = Eigen::Matrix<double, 9, 1>;
using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Scalar = Eigen::Matrix<double, 1, 1>;

/// Integrals of a likelihood over times, of order 0 to 2 in (time - mean).
struct Moments {
  double zeroth, first, second;
};

/// @param a, b  where the times begin and end, from the mean of the likelihood
/// @param information  the inverse of its variance; 0: all times are alike
Moments moments(double a, double b, double information) {
  if (information * std::max(a * a, b * b) <= 1e-6)
    return {b - a, 0.5 * (b * b - a * a), (b * b * b - a * a * a) / 3.0};
  const auto density = [=](double time) { return std::exp(-0.5 * information * time * time); };
  const double scale = std::sqrt(0.5 * information);
  const double zeroth = 0.5 * std::sqrt(M_PI) / scale * (std::erf(scale * b) - std::erf(scale * a));
  return {zeroth, (density(a) - density(b)) / information,
          (zeroth + a * density(a) - b * density(b)) / information};
}

}  // namespace

void ReadoutEstimator::Evidence::add(double time, double variance_of_images, double variance_of_motion) {
  const double weight = 1.0 / (variance_of_images + variance_of_motion);
  weights += weight;
  times += weight * time;
  of_images += weight * variance_of_images;
  of_motion += weight * weight * variance_of_motion;
}

ReadoutEstimator::Belief ReadoutEstimator::Evidence::mean() const {
  return {times / weights, of_images / weights + of_motion / (weights * weights)};
}

void ReadoutEstimator::observe(const CalibrationEquations& equations, Stamp keyframe,
                               const Vector6& velocity_variances, double aligned_time, double interval) {
  const Eigen::LDLT<Matrix9> ldlt(equations.H.topLeftCorner<9, 9>());
  const Vector9 step = ldlt.solve(equations.g.head<9>()), by_gradient = ldlt.solve(Vector9::Unit(kReadout));
  Scalar scatter(by_gradient(kReadout));
  const auto gradient = [&](const CalibrationEquations::Part& strip) -> Scalar {
    return by_gradient.transpose() * (strip.g.head<9>() - strip.H.topLeftCorner<9, 9>() * step);
  };
  addScatter(equations.strips, gradient, scatter);
  // A velocity that is off by δ moves the image's edges by δ times half of the readout time.
  const Vector6 by_motion = gradientByReadout<9>(equations.strips).transpose() * by_gradient;
  const double square_time = now_.time * now_.time + now_.variance;
  const double of_images = interval * interval * scatter.value();
  const double of_motion = interval * interval * by_motion.cwiseAbs2().dot(velocity_variances) * square_time;
  const double time = aligned_time + step(kReadout) * interval;
  // A frame that tells less than is known at the start is not used: the camera hardly moved.
  const bool is_useful =
      of_images > 0.0 && of_images + of_motion < kStartSigma * kStartSigma && std::isfinite(time);
  if (!is_useful) return;
  if (keyframe != keyframe_) {
    keyframe_ = keyframe;
    frames_ = Evidence();
    before_ = now_;
  }
  frames_.add(time, of_images, of_motion);
  const Belief said = frames_.mean();
  const double gain = before_.variance / (before_.variance + said.variance);
  now_.time = std::clamp(before_.time + gain * (said.time - before_.time), -interval, interval);
  now_.variance = std::max((1.0 - gain) * before_.variance, kStationary * kStationary);
}

double ReadoutEstimator::readoutTime() const {
  // A shutter is global, or rolling and no faster than the fastest: what is nearer to 0 is noise.
  return std::abs(now_.time) < kFastestReadout / 2.0 ? 0.0 : now_.time;
}

double ReadoutEstimator::sigma() const {
  const double slowest = std::max(kSlowestReadout, std::abs(now_.time)), reported = readoutTime();
  // What the frames alone say, without the filter's start.
  const double information = std::max(1.0 / now_.variance - 1.0 / (kStartSigma * kStartSigma), 0.0);
  const double weighted = now_.time / now_.variance - start_ / (kStartSigma * kStartSigma);
  const double mean = information > 0.0 ? std::clamp(weighted / information, -slowest, slowest) : 0.0;
  // Over the times of a rolling shutter, read from the top or from the bottom.
  const Moments down = moments(kFastestReadout - mean, slowest - mean, information),
                up = moments(-slowest - mean, -kFastestReadout - mean, information);
  const double rolling = down.zeroth + up.zeroth, first = down.first + up.first,
               second = down.second + up.second, off = mean - reported;
  const double square = second + 2.0 * off * first + off * off * rolling;
  // Before the first frame, both kinds of shutter are equally probable, and so are all times of a rolling
  // one.
  const double global = 2.0 * (slowest - kFastestReadout) * std::exp(-0.5 * information * mean * mean);
  return std::sqrt(std::max(square + global * reported * reported, 0.0) / (rolling + global));
}

}  // namespace rgbd_sfm_fusion
