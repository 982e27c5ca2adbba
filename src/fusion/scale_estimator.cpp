// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/scale_estimator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "rgbd_sfm_fusion/median.h"
#include "rgbd_sfm_fusion/radix_sort.h"
#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

/// Every estimator is the root of a sum over pixels, Σ ψ(q; α) = 0.
struct TileSums {
  double psi = 0.0;    ///< at the root
  double slope = 0.0;  ///< -∂ψ/∂α
  std::size_t samples = 0;
};
using Tiles = std::array<TileSums, Overlap::kTiles>;

struct Fit {
  double alpha = std::numeric_limits<double>::quiet_NaN();
  Tiles tiles;
  std::size_t inliers = 0;    ///< of the samples
  double residual_sum = 0.0;  ///< Σ (d/(αμ) - 1)² over the inliers
  double spread = 1.0;        ///< spread of the ratios over the expected spread
};

int tilesWithData(const Tiles& tiles) {
  return static_cast<int>(std::count_if(tiles.begin(), tiles.end(), [](const TileSums& tile) {
    return tile.samples >= Overlap::kMinTileSamples;
  }));
}

/// Delete-one-tile jackknife. Errors of adjacent tiles may be alike, so their products count, with the
/// weights of a triangular window (Conley 1999), which keep the sum positive. With few degrees of freedom,
/// the result follows Student's t, whose variance is larger.
double jackknifeVariance(const Tiles& tiles) {
  double slope = 0.0;
  for (const TileSums& tile : tiles) slope += tile.slope;
  std::array<double, Overlap::kTiles> change{};  // of the root, if this tile is left out: one Newton step
  double n = 0.0, mean = 0.0;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    if (tiles[i].samples < Overlap::kMinTileSamples) continue;
    change[i] = -tiles[i].psi / (slope - tiles[i].slope);
    mean += change[i];
    n += 1.0;
  }
  mean /= n;
  double sum = 0.0;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    for (std::size_t j = 0; j < tiles.size(); ++j) {
      if (tiles[i].samples < Overlap::kMinTileSamples || tiles[j].samples < Overlap::kMinTileSamples)
        continue;
      sum += Overlap::adjacency(i, j) * (change[i] - mean) * (change[j] - mean);
    }
  }
  return sum * (n - 1.0) / n * (n - 1.0) / (n - 3.0);
}

/// The paper's estimators, Σ w (d - αμ) = 0 with all pixels: w = 1/μ for the mean ratio (Eq. 10), μ for least
/// squares (Eq. 9).
Fit fitSums(const Overlap& overlap, bool least_squares) {
  Fit fit;
  double numerator = 0.0, denominator = 0.0;
  const auto weight = [&](double mu) { return least_squares ? mu : 1.0 / mu; };
  for (std::size_t i = 0; i < overlap.size(); ++i) {
    const double mu = static_cast<double>(overlap.sfm[i]), d = static_cast<double>(overlap.sensor[i]);
    numerator += weight(mu) * d;
    denominator += weight(mu) * mu;
  }
  fit.alpha = numerator / denominator;
  fit.inliers = overlap.size();
  for (std::size_t i = 0; i < overlap.size(); ++i) {
    const double mu = static_cast<double>(overlap.sfm[i]), d = static_cast<double>(overlap.sensor[i]);
    TileSums& tile = fit.tiles[overlap.tile[i]];
    tile.psi += weight(mu) * (d - fit.alpha * mu);
    tile.slope += weight(mu) * mu;
    ++tile.samples;
    fit.residual_sum += std::pow(d / (fit.alpha * mu) - 1.0, 2.0);
  }
  return fit;
}

/// The robust fit's data: ratios q = d/μ, and 1/(expected relative error of q).
struct Ratios {
  std::vector<float> q, inverse_sigma;
  std::vector<std::uint8_t> tile;

  /// Pads with ratios that are outside of every window.
  void padToLanes() {
    const auto size = static_cast<std::size_t>(paddedToLanes(static_cast<int>(q.size())));
    q.resize(size, 1e10f);
    inverse_sigma.resize(size, 1.0f);
  }
};

Ratios ratios(const Overlap& overlap, double alpha) {
  const auto sigma_rho = overlap.meanInverseDepthSigma();
  Ratios result;
  result.q.reserve(overlap.size());
  result.inverse_sigma.reserve(overlap.size());
  result.tile.reserve(overlap.size());
  for (std::size_t i = 0; i < overlap.size(); ++i) {
    const float mu = overlap.sfm[i], d = overlap.sensor[i];
    // α/d is the inverse SfM depth that the sensor predicts.
    const auto sfm_sigma = static_cast<float>(sigma_rho[overlap.tile[i]] / alpha) * d;
    const float relative_variance = sfm_sigma * sfm_sigma + overlap.sensor_variance[i] / (d * d);
    result.q.push_back(d / mu);
    result.inverse_sigma.push_back(1.0f / std::sqrt(relative_variance + 1e-8f));
    result.tile.push_back(overlap.tile[i]);
  }
  return result;
}

/// Returns z, where P(|N(0, 1)| < z) = `share`.
double halfLengthOfNormal(double share) {
  double low = 0.0, high = 4.0;
  while (high - low > 1e-6) {
    const double middle = 0.5 * (low + high);
    (std::erf(middle / std::sqrt(2.0)) < share ? low : high) = middle;
  }
  return low;
}

/// Standard deviation of N(0, 1) cut off at ±c.
double sigmaCutOff(double c) {
  return std::sqrt(1.0 -
                   2.0 * c * std::exp(-0.5 * c * c) / std::sqrt(2.0 * M_PI) / std::erf(c / std::sqrt(2.0)));
}

/// The densest place of the ratios, and their spread there.
struct Start {
  double alpha, spread;
};

/// Finds the shortest interval that holds as many of the ratios as a fit needs: so many belong together even
/// where a large part of the overlap is wrong in the same way. Logarithms are used, so that small ratios do
/// not look dense. The middle of the interval gives α. Its length gives the spread, once the share of ratios
/// that belong there is estimated.
Start densest(const Overlap& overlap, double share) {
  std::vector<float> logs(overlap.size());
  for (std::size_t i = 0; i < logs.size(); ++i) logs[i] = std::log(overlap.sensor[i] / overlap.sfm[i]);
  radixSort(&logs);
  const auto held = static_cast<std::size_t>(share * static_cast<double>(logs.size() - 1));
  std::size_t best = 0;
  for (std::size_t i = 0; i + held < logs.size(); ++i) {
    if (logs[i + held] - logs[i] < logs[best + held] - logs[best]) best = i;
  }
  const auto length = static_cast<double>(0.5f * (logs[best + held] - logs[best]));
  const double middle = static_cast<double>(logs[best]) + length;
  const double spread = length / halfLengthOfNormal(share);  // if all ratios belong there
  const auto window = [&](double side) {
    return static_cast<float>(middle + side * Overlap::kTukeyWidth * spread);
  };
  const auto first = std::lower_bound(logs.begin(), logs.end(), window(-1.0));
  const auto last = std::upper_bound(first, logs.end(), window(1.0));
  const double belong = static_cast<double>(last - first) / static_cast<double>(logs.size());
  return {std::exp(middle), length / halfLengthOfNormal(std::min(share / belong, 0.95))};
}

/// Tukey's window around a scale.
struct Window {
  float inverse_alpha, inverse_width;

  Window(double alpha, double spread)
      : inverse_alpha(static_cast<float>(1.0 / alpha)),
        inverse_width(static_cast<float>(1.0 / (Overlap::kTukeyWidth * spread))) {}

  float error(float q, float inverse_sigma) const { return (q * inverse_alpha - 1.0f) * inverse_sigma; }
};

struct RobustSums {
  double weight = 0.0, weighted_q = 0.0, squared_error = 0.0, inliers = 0.0;
};

/// Lane l sums the samples l, l + kLanes, l + 2 kLanes, …
struct LaneSums {
  float weight[kLanes], weighted_q[kLanes], squared_error[kLanes], inliers[kLanes];
};

RGBD_SFM_FUSION_MULTIVERSION
void addTukey(const float* q, const float* inverse_sigma, std::size_t count, const Window window,
              LaneSums& __restrict result) {
  LaneSums sums{};
  for (std::size_t i = 0; i < count; i += kLanes, q += kLanes, inverse_sigma += kLanes) {
    for (int l = 0; l < kLanes; ++l) {
      const float error = window.error(q[l], inverse_sigma[l]);
      const float u = error * window.inverse_width, inside = u * u < 1.0f ? 1.0f : 0.0f;
      const float root = inside * (1.0f - u * u) * inverse_sigma[l];
      const float weight = root * root;
      sums.weight[l] += weight;
      sums.weighted_q[l] += weight * q[l];
      sums.squared_error[l] += inside * error * error;
      sums.inliers[l] += inside;
    }
  }
  result = sums;
}

/// Sums over the samples inside the window.
RobustSums tukeySums(const Ratios& data, const Window& window) {
  LaneSums lanes;
  addTukey(data.q.data(), data.inverse_sigma.data(), data.q.size(), window, lanes);
  RobustSums sums;
  for (int l = 0; l < kLanes; ++l) {
    sums.weight += static_cast<double>(lanes.weight[l]);
    sums.weighted_q += static_cast<double>(lanes.weighted_q[l]);
    sums.squared_error += static_cast<double>(lanes.squared_error[l]);
    sums.inliers += static_cast<double>(lanes.inliers[l]);
  }
  return sums;
}

/// Sums ψ and its slope at `alpha` for each tile.
void sumTiles(const Ratios& data, double alpha, const Window& window, Fit* fit) {
  for (std::size_t i = 0; i < data.tile.size(); ++i) {
    const float u = window.error(data.q[i], data.inverse_sigma[i]) * window.inverse_width;
    if (u * u >= 1.0f) continue;
    const double error = static_cast<double>(data.q[i]) / alpha - 1.0;
    const double square = static_cast<double>(u * u);
    const double precision = static_cast<double>(data.inverse_sigma[i] * data.inverse_sigma[i]);
    TileSums& tile = fit->tiles[data.tile[i]];
    tile.psi += precision * (1.0 - square) * (1.0 - square) * alpha * error;
    tile.slope += precision * (1.0 - square) * (1.0 - 5.0 * square);
    ++tile.samples;
    ++fit->inliers;
    fit->residual_sum += error * error;
  }
}

/// Iteratively reweighted least squares. The spread is estimated anew inside the window in each round.
Fit fitRobust(const Overlap& overlap, double min_inliers) {
  constexpr double kLeastSpread =
      1e-3;  // [stated σ] of exact data: with less, what rounding leaves would look certain
  Fit fit;
  if (overlap.size() == 0) return fit;
  const Start start = densest(overlap, min_inliers);
  double alpha = start.alpha;
  Ratios data = ratios(overlap, alpha);
  const float usual = median(std::vector<float>(data.inverse_sigma));
  const auto rounding = static_cast<double>(usual * std::numeric_limits<float>::epsilon());
  double spread = std::max(start.spread * static_cast<double>(usual), kLeastSpread);
  data.padToLanes();
  for (int iteration = 0; iteration < Overlap::kRounds; ++iteration) {
    const RobustSums sums = tukeySums(data, {alpha, spread});
    if (sums.inliers == 0.0) return fit;
    const double before = alpha;
    alpha = sums.weighted_q / sums.weight;
    const double inside = std::sqrt(sums.squared_error / sums.inliers) / sigmaCutOff(Overlap::kTukeyWidth);
    const double wider = spread;
    spread = std::clamp(inside, kLeastSpread, spread);  // a growing window would take in outliers
    if (std::abs(alpha - before) < rounding * alpha && wider - spread < rounding) break;
  }
  fit.alpha = alpha;
  fit.spread = spread;
  sumTiles(data, alpha, {alpha, spread}, &fit);
  return fit;
}

}  // namespace

ScaleEstimate fitScale(const Overlap& overlap, const ScaleOptions& options) {
  ScaleEstimate estimate;
  if (overlap.pixels < static_cast<std::size_t>(options.min_pixels)) return estimate;
  const bool robust = options.estimator == ScaleEstimatorKind::kWeightedRobust;
  const Fit fit = robust ? fitRobust(overlap, options.min_inliers)
                         : fitSums(overlap, options.estimator == ScaleEstimatorKind::kLeastSquares);
  const double share = static_cast<double>(fit.inliers) / static_cast<double>(overlap.size());
  if (share < options.min_inliers || tilesWithData(fit.tiles) < options.min_tiles) return estimate;

  const double floor = options.sigma_floor * fit.alpha;
  const double variance = jackknifeVariance(fit.tiles) + floor * floor;
  if (!std::isfinite(fit.alpha) || !(variance >= 0.0) || fit.alpha <= 0.0) return estimate;
  estimate.alpha = fit.alpha;
  estimate.sigma = std::sqrt(variance);
  estimate.inliers = static_cast<std::uint32_t>(share * static_cast<double>(overlap.pixels) + 0.5);
  estimate.residual = std::sqrt(fit.residual_sum / static_cast<double>(fit.inliers));
  estimate.spread = fit.spread;
  estimate.refused = false;
  return estimate;
}

}  // namespace rgbd_sfm_fusion
