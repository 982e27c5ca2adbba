// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/readout_estimation.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace rgbd_sfm_fusion {
namespace {

// These numbers were found on recordings of a Kinect (28 ms) and on rendered ones (0).
constexpr double kInflation = 10.5;      // of a frame's sigma: its pixels' errors are alike
constexpr double kFrameSigma = 0.004;    // [s] sigma of the best frames
constexpr double kStationary = 0.00073;  // [s] sigma that remains, so that the filter forgets in 30 frames

constexpr int kReadout = CalibrationEquations::kReadout;  // the last of the parameters that are used here
using Vector9 = Eigen::Matrix<double, 9, 1>;
using Matrix9 = Eigen::Matrix<double, 9, 9>;

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

void ReadoutEstimator::observe(const CalibrationEquations& equations, double aligned_time, double interval) {
  const Eigen::LDLT<Matrix9> ldlt(equations.H.topLeftCorner<9, 9>());
  const double deviation = ldlt.solve(equations.g.head<9>())(kReadout) * interval;
  const double scatter = ldlt.solve(Vector9::Unit(kReadout))(kReadout) * interval * interval;
  const double variance = kInflation * kInflation * scatter + kFrameSigma * kFrameSigma;
  // A frame that tells less than is known at the start is not used: the camera hardly moved.
  const bool is_useful = scatter > 0.0 && variance < kStartSigma * kStartSigma && std::isfinite(deviation);
  if (!is_useful) return;
  const double gain = variance_ / (variance_ + variance);
  const double change = aligned_time + deviation - time_;
  time_ = std::clamp(time_ + gain * change, -interval, interval);
  variance_ = std::max((1.0 - gain) * variance_, kStationary * kStationary);
}

double ReadoutEstimator::readoutTime() const {
  // A shutter is global, or rolling and no faster than the fastest: what is nearer to 0 is noise.
  return std::abs(time_) < kFastestReadout / 2.0 ? 0.0 : time_;
}

double ReadoutEstimator::sigma() const {
  const double slowest = std::max(kSlowestReadout, std::abs(time_)), reported = readoutTime();
  // What the frames alone say, without the filter's start.
  const double information = std::max(1.0 / variance_ - 1.0 / (kStartSigma * kStartSigma), 0.0);
  const double weighted = time_ / variance_ - start_ / (kStartSigma * kStartSigma);
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
