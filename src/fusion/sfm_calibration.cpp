// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/sfm_calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "rgbd_sfm_fusion/median.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kGain = 0.1;           // weight of a new frame against the frames before
constexpr double kLeastStretch = 0.05;  // [1] a slope that is known as well as this counts a quarter
constexpr double kStretchGain = 0.033;  // the same for the stretch: one keyframe says little of others
constexpr std::size_t kMinTileSamples = 20;
constexpr std::size_t kMinTiles = 6;      // of a frame that tells something of regions
constexpr std::size_t kMinSamples = 200;  // of a frame, at which the sensor is the better of the two

/// Median differences of inverse depth, SfM less sensor, of tiles with enough pixels.
struct TileMedians {
  std::vector<double> inverse_depth, difference;  // [1/m]
};

TileMedians tileMedians(const Overlap& overlap, double alpha) {
  std::array<std::vector<float>, Overlap::kTiles> inverse_depths, differences;
  for (std::size_t tile = 0; tile < Overlap::kTiles; ++tile) {
    inverse_depths[tile].reserve(2 * overlap.size() / Overlap::kTiles);
    differences[tile].reserve(2 * overlap.size() / Overlap::kTiles);
  }
  for (std::size_t i = 0; i < overlap.size(); ++i) {
    const float z = static_cast<float>(alpha) * overlap.sfm[i];
    inverse_depths[overlap.tile[i]].push_back(1.0f / overlap.sensor[i]);
    differences[overlap.tile[i]].push_back(1.0f / z - 1.0f / overlap.sensor[i]);
  }
  TileMedians medians;
  for (std::size_t tile = 0; tile < Overlap::kTiles; ++tile) {
    if (differences[tile].size() < kMinTileSamples) continue;
    medians.inverse_depth.push_back(static_cast<double>(median(inverse_depths[tile])));
    medians.difference.push_back(static_cast<double>(median(differences[tile])));
  }
  return medians;
}

/// Line by weighted least squares.
struct Line {
  double slope = 0.0, x = 0.0, y = 0.0;  // through (x, y)
  double spread = 0.0;                   // Σ w (x_i - x)²

  double residual(double xi, double yi) const { return yi - y - slope * (xi - x); }
};

Line fitLine(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& weights) {
  Line line;
  double sum = 0.0, product = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += weights[i];
    line.x += weights[i] * x[i];
    line.y += weights[i] * y[i];
  }
  line.x /= sum;
  line.y /= sum;
  for (std::size_t i = 0; i < x.size(); ++i) {
    line.spread += weights[i] * (x[i] - line.x) * (x[i] - line.x);
    product += weights[i] * (x[i] - line.x) * (y[i] - line.y);
  }
  line.slope = product / line.spread;
  return line;
}

double sharedSigma(const TileMedians& tiles) {
  std::vector<float> sizes;
  for (const double difference : tiles.difference) sizes.push_back(static_cast<float>(std::abs(difference)));
  if (sizes.size() < kMinTiles) return std::numeric_limits<double>::quiet_NaN();
  return kSigmaOfMedian * static_cast<double>(median(sizes));
}

Stretch fitStretch(const TileMedians& tiles) {
  constexpr double kTukey = 4.685;      // [σ]
  constexpr double kLeastSigma = 1e-4;  // [1/m] of a tile, as all tiles may fit to the last digit
  const std::size_t count = tiles.difference.size();
  if (count < kMinTiles) return {};
  std::vector<double> weights(count, 1.0);
  Stretch stretch;
  for (int iteration = 0; iteration < Overlap::kRounds; ++iteration) {
    const Line line = fitLine(tiles.inverse_depth, tiles.difference, weights);
    std::vector<float> sizes;
    for (std::size_t i = 0; i < count; ++i)
      sizes.push_back(
          static_cast<float>(std::abs(line.residual(tiles.inverse_depth[i], tiles.difference[i]))));
    const double sigma = kSigmaOfMedian * static_cast<double>(median(sizes)) + kLeastSigma;
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const double u = line.residual(tiles.inverse_depth[i], tiles.difference[i]) / (kTukey * sigma);
      weights[i] = std::pow(std::max(0.0, 1.0 - u * u), 2);
      sum += weights[i];
    }
    stretch = {line.slope, sigma * sigma / line.spread, line.x};
    if (!(sum > 0.0)) return {};
  }
  return std::isfinite(stretch.slope) && std::isfinite(stretch.slope_variance) ? stretch : Stretch();
}

}  // namespace

double sfmVarianceFactor(const Overlap& overlap, double alpha, double shared_sigma) {
  std::vector<float> ratios;
  ratios.reserve(overlap.size());
  const auto scale = static_cast<float>(alpha);
  for (std::size_t i = 0; i < overlap.size(); ++i) {
    const float variance = scale * scale * overlap.sfm_variance[i];
    if (!(variance > overlap.sensor_variance[i])) continue;
    const float difference = overlap.sensor[i] - scale * overlap.sfm[i];
    const float z = scale * overlap.sfm[i], shared = static_cast<float>(shared_sigma) * z * z;
    ratios.push_back(difference * difference / (variance + overlap.sensor_variance[i] + shared * shared));
  }
  if (ratios.size() < kMinSamples) return std::numeric_limits<double>::quiet_NaN();
  return std::clamp(static_cast<double>(median(ratios)) * kSigmaOfMedian * kSigmaOfMedian, 0.05, 100.0);
}

double sharedInverseDepthSigma(const Overlap& overlap, double alpha) {
  return sharedSigma(tileMedians(overlap, alpha));
}

Stretch fitStretch(const Overlap& overlap, double alpha) {
  return fitStretch(tileMedians(overlap, alpha));
}

void SfmCalibration::observe(const Overlap& overlap, double alpha) {
  const TileMedians tiles = tileMedians(overlap, alpha);
  const double shared = sharedSigma(tiles);
  const double gain = shared_variance_ > 0.0 ? kGain : 1.0;
  if (!std::isnan(shared)) shared_variance_ += gain * (shared * shared - shared_variance_);
  const double factor = sfmVarianceFactor(overlap, alpha, std::sqrt(shared_variance_));
  if (!std::isnan(factor)) factor_ = factor_ > 0.0 ? factor_ * std::pow(factor / factor_, kGain) : factor;
  observeStretch(fitStretch(tiles));
}

void SfmCalibration::observeStretch(const Stretch& stretch) {
  if (std::isnan(stretch.slope)) return;
  // An overlap of little depth hardly shows the slope, and counts little.
  constexpr double kLeast = kLeastStretch * kLeastStretch;
  const double weight = std::pow(kLeast / (kLeast + stretch.slope_variance), 2);
  stretch_weight_ = (1.0 - kStretchGain) * stretch_weight_ + weight;
  stretch_variance_ +=
      weight / stretch_weight_ * (stretch.slope * stretch.slope - stretch.slope_variance - stretch_variance_);
  stretch_middle_ = stretch.middle;
}

SfmErrors SfmCalibration::errors() const {
  SfmErrors errors;
  if (!(factor_ > 0.0)) return errors;
  errors.variance_factor = factor_;
  errors.shared_sigma = std::sqrt(shared_variance_);
  errors.stretch_sigma = std::sqrt(std::max(0.0, stretch_variance_));
  errors.stretch_middle = stretch_middle_;
  return errors;
}

}  // namespace rgbd_sfm_fusion
