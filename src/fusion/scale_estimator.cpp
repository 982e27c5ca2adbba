// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/scale_estimator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace rgbd_sfm_fusion {
namespace {

/// Tukey's biweight vanishes this many standard deviations away. Small, for asymmetric outliers; 3 costs a
/// tenth of the efficiency at Gaussian errors, of which there are plenty.
constexpr double kTukeyWidth = 3.0;
/// Standard deviation of N(0, 1) cut off at ±kTukeyWidth.
constexpr double kTruncatedSigma = 0.9866;
constexpr double kMadToSigma = 1.4826;
/// Of a pixel's SfM depth; where σ/μ is larger, μ is hardly a measurement.
constexpr double kMaxRelativeSigma = 0.5;
constexpr int kMinTileSamples = 5;

/// Every estimator is a ratio of sums, numerator / denominator, over the pixels of the tiles.
struct TileSums {
  double numerator = 0.0, denominator = 0.0;
  int samples = 0;
};
using Tiles = std::array<TileSums, Overlap::kTiles>;

struct Fit {
  Tiles tiles;
  std::size_t inliers = 0;    ///< of the samples
  double residual_sum = 0.0;  ///< Σ (d/(αμ) - 1)² over the inliers
};

double ratio(const Tiles& tiles) {
  double numerator = 0.0, denominator = 0.0;
  for (const TileSums& tile : tiles) {
    numerator += tile.numerator;
    denominator += tile.denominator;
  }
  return numerator / denominator;
}

int tilesWithData(const Tiles& tiles) {
  return static_cast<int>(std::count_if(
      tiles.begin(), tiles.end(), [](const TileSums& tile) { return tile.samples >= kMinTileSamples; }));
}

/// Delete-one-tile jackknife. Its few degrees of freedom make the estimate follow Student's t, the variance
/// of which is larger.
double jackknifeVariance(const Tiles& tiles) {
  double numerator = 0.0, denominator = 0.0;
  for (const TileSums& tile : tiles) {
    numerator += tile.numerator;
    denominator += tile.denominator;
  }
  std::vector<double> without_one;
  for (const TileSums& tile : tiles) {
    if (tile.samples >= kMinTileSamples && tile.denominator < denominator)
      without_one.push_back((numerator - tile.numerator) / (denominator - tile.denominator));
  }
  const auto n = static_cast<double>(without_one.size());
  const double mean = std::accumulate(without_one.begin(), without_one.end(), 0.0) / n;
  double sum = 0.0;
  for (const double value : without_one) sum += (value - mean) * (value - mean);
  return sum * (n - 1.0) / n * (n - 1.0) / (n - 3.0);
}

float median(std::vector<float>* values) {
  const auto middle = values->begin() + static_cast<std::ptrdiff_t>(values->size() / 2);
  std::nth_element(values->begin(), middle, values->end());
  return *middle;
}

/// The paper's sums: all pixels count. `weight` of a pixel is μ^power: 0 = mean ratio, 2 = least squares.
Fit fitSums(const Overlap& overlap, bool least_squares) {
  Fit fit;
  for (std::size_t i = 0; i < overlap.size(); ++i) {
    const double mu = static_cast<double>(overlap.sfm[i]), d = static_cast<double>(overlap.sensor[i]);
    TileSums& tile = fit.tiles[overlap.tile[i]];
    tile.numerator += least_squares ? d * mu : d / mu;
    tile.denominator += least_squares ? mu * mu : 1.0;
    ++tile.samples;
  }
  fit.inliers = overlap.size();
  const double alpha = ratio(fit.tiles);
  for (std::size_t i = 0; i < overlap.size(); ++i) {
    const double error = static_cast<double>(overlap.sensor[i] / overlap.sfm[i]) / alpha - 1.0;
    fit.residual_sum += error * error;
  }
  return fit;
}

/// Mean σ_ρ = σ/μ² of each tile's SfM depths.
std::array<double, Overlap::kTiles> meanInverseDepthSigma(const Overlap& overlap) {
  std::array<double, Overlap::kTiles> sum{}, count{};
  for (std::size_t i = 0; i < overlap.size(); ++i) {
    sum[overlap.tile[i]] +=
        static_cast<double>(std::sqrt(overlap.sfm_variance[i]) / (overlap.sfm[i] * overlap.sfm[i]));
    count[overlap.tile[i]] += 1.0;
  }
  for (std::size_t tile = 0; tile < sum.size(); ++tile) sum[tile] /= std::max(count[tile], 1.0);
  return sum;
}

/// The robust fit's data: ratios q = d/μ, and 1/(expected relative error of q).
struct Ratios {
  std::vector<float> q, inverse_sigma;
  std::vector<std::uint8_t> tile;
};

Ratios ratios(const Overlap& overlap, double alpha) {
  const auto sigma_rho = meanInverseDepthSigma(overlap);
  Ratios result;
  result.q.reserve(overlap.size());
  result.inverse_sigma.reserve(overlap.size());
  result.tile.reserve(overlap.size());
  constexpr auto kLimit = static_cast<float>(kMaxRelativeSigma * kMaxRelativeSigma);
  for (std::size_t i = 0; i < overlap.size(); ++i) {
    const float mu = overlap.sfm[i], d = overlap.sensor[i];
    if (!(overlap.sfm_variance[i] <= kLimit * mu * mu)) continue;
    // α/d is the inverse SfM depth that the sensor predicts.
    const auto sfm_sigma = static_cast<float>(sigma_rho[overlap.tile[i]] / alpha) * d;
    const float relative_variance = sfm_sigma * sfm_sigma + overlap.sensor_variance[i] / (d * d);
    result.q.push_back(d / mu);
    result.inverse_sigma.push_back(1.0f / std::sqrt(relative_variance + 1e-8f));
    result.tile.push_back(overlap.tile[i]);
  }
  return result;
}

double spread(const Ratios& data, double alpha) {
  std::vector<float> errors(data.q.size());
  for (std::size_t i = 0; i < errors.size(); ++i)
    errors[i] = std::abs(data.q[i] / static_cast<float>(alpha) - 1.0f) * data.inverse_sigma[i];
  return kMadToSigma * static_cast<double>(median(&errors));
}

struct RobustSums {
  double weight = 0.0, weighted_q = 0.0, squared_error = 0.0;
  std::size_t inliers = 0;
};

/// Calls `visit(i, weight)` for the samples inside Tukey's window around `alpha`.
template <typename Visitor>
RobustSums tukeySums(const Ratios& data, double alpha, double spread, const Visitor& visit) {
  RobustSums sums;
  const auto inverse_alpha = static_cast<float>(1.0 / alpha);
  const auto inverse_width = static_cast<float>(1.0 / (kTukeyWidth * spread));
  for (std::size_t i = 0; i < data.q.size(); ++i) {
    const float inverse_sigma = data.inverse_sigma[i];
    const float error = (data.q[i] * inverse_alpha - 1.0f) * inverse_sigma;
    const float u = error * inverse_width;
    if (u * u >= 1.0f) continue;
    const float root = (1.0f - u * u) * inverse_sigma;
    const auto weight = static_cast<double>(root * root);
    sums.weight += weight;
    sums.weighted_q += weight * static_cast<double>(data.q[i]);
    sums.squared_error += static_cast<double>(error * error);
    ++sums.inliers;
    visit(i, weight);
  }
  return sums;
}

/// Iteratively reweighted, from the median, with the spread re-estimated inside the window.
Fit fitRobust(const Overlap& overlap) {
  constexpr int kMaxIterations = 30;
  constexpr double kConverged = 1e-6, kLeastSpread = 1e-3;
  Fit fit;
  std::vector<float> q(overlap.size());
  for (std::size_t i = 0; i < q.size(); ++i) q[i] = overlap.sensor[i] / overlap.sfm[i];
  if (q.empty()) return fit;
  double alpha = static_cast<double>(median(&q));
  const Ratios data = ratios(overlap, alpha);
  if (data.q.empty()) return fit;
  double width = std::max(spread(data, alpha), kLeastSpread);
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const RobustSums sums = tukeySums(data, alpha, width, [](std::size_t, double) {});
    if (sums.inliers == 0) return fit;
    const double previous = alpha;
    alpha = sums.weighted_q / sums.weight;
    width = std::max(std::sqrt(sums.squared_error / static_cast<double>(sums.inliers)) / kTruncatedSigma,
                     kLeastSpread);
    if (std::abs(alpha - previous) < kConverged * alpha && iteration >= 5) break;
  }
  const RobustSums sums = tukeySums(data, alpha, width, [&](std::size_t i, double weight) {
    TileSums& tile = fit.tiles[data.tile[i]];
    tile.numerator += weight * static_cast<double>(data.q[i]);
    tile.denominator += weight;
    ++tile.samples;
    const double error = static_cast<double>(data.q[i]) / alpha - 1.0;
    fit.residual_sum += error * error;
  });
  fit.inliers = sums.inliers;
  return fit;
}

}  // namespace

ScaleEstimate fitScale(const Overlap& overlap, const ScaleOptions& options) {
  ScaleEstimate estimate;
  if (overlap.pixels < static_cast<std::size_t>(options.min_pixels)) return estimate;
  const bool robust = options.estimator == ScaleEstimatorKind::kWeightedRobust;
  const Fit fit =
      robust ? fitRobust(overlap) : fitSums(overlap, options.estimator == ScaleEstimatorKind::kLeastSquares);
  const double share = static_cast<double>(fit.inliers) / static_cast<double>(overlap.size());
  if (share < options.min_inliers || tilesWithData(fit.tiles) < options.min_tiles) return estimate;

  const double alpha = ratio(fit.tiles);
  const double floor = options.sigma_floor * alpha;
  const double variance = jackknifeVariance(fit.tiles) + floor * floor;
  if (!std::isfinite(alpha) || !std::isfinite(variance) || alpha <= 0.0) return estimate;
  estimate.alpha = alpha;
  estimate.sigma = std::sqrt(variance);
  estimate.inliers = static_cast<std::uint32_t>(share * static_cast<double>(overlap.pixels) + 0.5);
  estimate.residual = std::sqrt(fit.residual_sum / static_cast<double>(fit.inliers));
  estimate.refused = false;
  return estimate;
}

ScaleEstimate ScaleFilter::update(const ScaleEstimate& fit, Stamp stamp, const ScaleOptions& options) {
  constexpr double kLongestGap = 10.0;      // [s]
  constexpr double kJumpChiSquared = 25.0;  // no chance, but another map: the scale starts anew
  const double dt = stamp_ == kNoStamp ? 0.0 : std::clamp(toSeconds(stamp - stamp_), 0.0, kLongestGap);
  stamp_ = stamp;
  const double walk = options.process_sigma * alpha_;
  variance_ += walk * walk * dt;

  const double measured = fit.sigma * fit.sigma;
  const double innovation = fit.alpha - alpha_;
  const bool starts = !(alpha_ > 0.0) || innovation * innovation > kJumpChiSquared * (variance_ + measured);
  if (!fit.refused && (starts || !options.filter)) {
    alpha_ = fit.alpha;
    variance_ = measured;
  } else if (!fit.refused) {
    // Fits within the correlation time repeat each other's errors: together they count as one.
    const double noise = measured * std::max(1.0, options.correlation_time / std::max(dt, 1e-3));
    const double gain = variance_ / (variance_ + noise);
    alpha_ += gain * innovation;
    variance_ *= 1.0 - gain;
  }

  ScaleEstimate filtered = fit;
  filtered.alpha = alpha_;
  filtered.sigma = options.sigma_alpha || !(alpha_ > 0.0) ? std::sqrt(variance_) : 0.0;
  return filtered;
}

}  // namespace rgbd_sfm_fusion
