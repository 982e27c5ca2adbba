// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/sfm_state.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "rgbd_sfm_fusion/median.h"

namespace rgbd_sfm_fusion {
namespace {

/// Mean over those pixels of a tile that are near its own median.
struct Tile {
  Eigen::Vector4d J = Eigen::Vector4d::Zero();  // (ρ, 1, x, y), with SfM's ρ
  double inverse_depth = 0.0;                   // [1/m] of the sensor
  double precision = 0.0;                       // of the mean, if errors were independent
  std::size_t samples = 0;
};
using Tiles = std::array<Tile, Overlap::kTiles>;

struct Sample {
  Eigen::Vector4d J;  // (ρ, 1, x, y), with SfM's ρ
  double sensor;      // [1/m] inverse depth
  double precision;   // [m²] of the expected difference of the two
  double root;        // [m] of the precision
  std::size_t tile;
};

/// The weight of a pixel must not depend on its own error. So the tile's mean gives SfM's σ of inverse depth.
std::vector<Sample> samplesOf(const Overlap& overlap, double alpha) {
  const std::array<double, Overlap::kTiles> sigma = overlap.meanInverseDepthSigma();
  std::vector<Sample> samples;
  samples.reserve(overlap.size());
  for (std::size_t i = 0; i < overlap.size(); ++i) {
    const std::size_t tile = overlap.tile[i];
    const double rho = 1.0 / static_cast<double>(overlap.sensor[i]), mean_sigma = sigma[tile] / alpha;
    const double variance =
        mean_sigma * mean_sigma + static_cast<double>(overlap.sensor_variance[i]) * rho * rho * rho * rho;
    const double root = 1.0 / std::sqrt(variance);
    samples.push_back({{1.0 / static_cast<double>(overlap.sfm[i]), 1.0, static_cast<double>(overlap.x[i]),
                        static_cast<double>(overlap.y[i])},
                       rho,
                       root * root,
                       root,
                       tile});
  }
  return samples;
}

/// [1/m²] Of the sensor's inverse depths.
double meanSquareOfSensor(const std::vector<Sample>& samples) {
  double sum = 0.0;
  for (const Sample& s : samples) sum += s.sensor * s.sensor;
  return sum / static_cast<double>(samples.size());
}

/// [1/m] Median difference of each tile's pixels from a fit; NaN for tiles with too few pixels. No pixel is
/// weighed by the fit: means of the pixels that fit would be drawn to it, and wrong tiles would not stand
/// out.
std::array<double, Overlap::kTiles> mediansOfTiles(const std::vector<Sample>& samples,
                                                   const Eigen::Vector4d& fit) {
  std::array<std::vector<double>, Overlap::kTiles> differences;
  for (std::vector<double>& of_tile : differences) of_tile.reserve(2 * samples.size() / Overlap::kTiles);
  for (const Sample& s : samples) differences[s.tile].push_back(s.sensor - s.J.dot(fit));
  std::array<double, Overlap::kTiles> medians;
  medians.fill(std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < medians.size(); ++i) {
    if (differences[i].size() >= Overlap::kMinTileSamples) medians[i] = median(std::move(differences[i]));
  }
  return medians;
}

/// Robust variance about zero, without what is NaN. 0 if all is.
double robustVariance(const std::array<double, Overlap::kTiles>& errors) {
  std::vector<double> sizes;
  for (const double error : errors) {
    if (!std::isnan(error)) sizes.push_back(std::abs(error));
  }
  return sizes.empty() ? 0.0 : std::pow(kSigmaOfMedian * median(std::move(sizes)), 2);
}

double tukey(double u) {
  return std::pow(std::max(0.0, 1.0 - u * u), 2);
}

/// @param centres  [1/m] of the tiles' differences from `fit`
Tiles meanTiles(const std::vector<Sample>& samples, const Eigen::Vector4d& fit, double spread,
                const std::array<double, Overlap::kTiles>& centres) {
  Tiles tiles;
  const double inverse_width = 1.0 / (Overlap::kTukeyWidth * spread);
  for (const Sample& s : samples) {
    if (std::isnan(centres[s.tile])) continue;
    const double off = s.sensor - s.J.dot(fit) - centres[s.tile];
    const double u = off * s.root * inverse_width, inside = 1.0 - u * u;
    if (inside <= 0.0) continue;
    const double weight = inside * inside * s.precision;
    Tile& tile = tiles[s.tile];
    tile.J += weight * s.J;
    tile.inverse_depth += weight * s.sensor;
    tile.precision += weight;
    ++tile.samples;
  }
  for (Tile& tile : tiles) {
    if (tile.precision == 0.0) continue;
    tile.J /= tile.precision;
    tile.inverse_depth /= tile.precision;
  }
  return tiles;
}

/// [1/m] How far tiles are off a fit; NaN for tiles with too few pixels.
std::array<double, Overlap::kTiles> residuals(const Tiles& tiles, const Eigen::Vector4d& fit) {
  std::array<double, Overlap::kTiles> result;
  result.fill(std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    if (tiles[i].samples >= Overlap::kMinTileSamples)
      result[i] = tiles[i].inverse_depth - tiles[i].J.dot(fit);
  }
  return result;
}

/// [1/m²] For weights: variance of the tiles' errors without `own`, the noise of their pixels. A fit with
/// four parameters follows the tiles, so their true errors are larger than the residuals.
double fieldVariance(const std::array<double, Overlap::kTiles>& residuals,
                     const std::array<double, Overlap::kTiles>& own) {
  std::vector<double> sizes, noise;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (std::isnan(residuals[i])) continue;
    sizes.push_back(std::abs(residuals[i]));
    noise.push_back(own[i]);
  }
  if (sizes.empty()) return 0.0;
  const double tiles = static_cast<double>(sizes.size()), freedom = std::max(tiles - 4.0, 2.0);
  const double sigma = kSigmaOfMedian * median(std::move(sizes));
  const double besides = sigma * sigma * std::max(tiles / freedom, 1.0) - median(std::move(noise));
  return std::max(besides, 0.0);
}

/// Variance of a sum over tiles, over the variance it would have if tiles erred independently. Adjacent tiles
/// count with the weights of a triangular window (Conley 1999).
double clustering(const std::array<double, Overlap::kTiles>& errors) {
  double own = 0.0, all = 0.0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    for (std::size_t j = 0; j < errors.size(); ++j) {
      const double product = Overlap::adjacency(i, j) * errors[i] * errors[j];
      if (std::isnan(product)) continue;
      own += i == j ? product : 0.0;
      all += product;
    }
  }
  return own > 0.0 ? std::max(all / own, 1.0) : 1.0;
}

StateEvidence evidenceOfScale(const ScaleEstimate& fit) {
  StateEvidence evidence;
  const double sigma = std::max(fit.sigma, 1e-9 * fit.alpha);              // exact data leave no sigma
  const double variance = std::pow(sigma / (fit.alpha * fit.alpha), 2.0);  // of 1/α
  evidence.information(0, 0) = 1.0 / variance;
  evidence.vector(0) = evidence.information(0, 0) / fit.alpha;
  evidence.of_scale_alone = true;
  return evidence;
}

}  // namespace

std::optional<StateEvidence> stateEvidence(const Overlap& overlap, const ScaleEstimate& fit,
                                           const ScaleOptions& options) {
  if (options.estimator != ScaleEstimatorKind::kWeightedRobust) return evidenceOfScale(fit);
  const std::vector<Sample> samples = samplesOf(overlap, fit.alpha);
  Eigen::Vector4d state(1.0 / fit.alpha, 0.0, 0.0, 0.0);
  // The fit is to show how large b and c are: all that is known is that they make no steps. Where tiles tell
  // nothing of b and c, this keeps them at zero.
  constexpr auto kRelative = static_cast<double>(kSurfaceStep);
  const double squared = kRelative * kRelative * meanSquareOfSensor(samples);
  const Eigen::Matrix4d prior = Eigen::Vector4d(0.0, 1.0, 1.0, 1.0).asDiagonal().toDenseMatrix() / squared;
  StateEvidence evidence;
  const std::array<double, Overlap::kTiles> centres = mediansOfTiles(samples, state);
  const Tiles tiles = meanTiles(samples, state, fit.spread, centres);
  std::array<double, Overlap::kTiles> own;
  for (std::size_t i = 0; i < tiles.size(); ++i)
    own[i] = Overlap::kPixelsOfOneError * fit.spread * fit.spread / tiles[i].precision;
  const double about_scale_alone = robustVariance(centres);
  std::array<double, Overlap::kTiles> weighted;  // errors, by what they say
  for (int iteration = 0; iteration < Overlap::kRounds; ++iteration) {
    const auto errors = residuals(tiles, state);
    weighted = errors;
    const double field = fieldVariance(errors, own);
    evidence = {};
    evidence.field_variance = about_scale_alone;
    double weights = 0.0;
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      if (std::isnan(errors[i])) continue;
      const double variance = field + own[i];
      const double inlier = tukey(errors[i] / (Overlap::kTukeyWidth * std::sqrt(variance)));
      const double weight = inlier / variance;
      weighted[i] *= inlier;
      evidence.information += weight * tiles[i].J * tiles[i].J.transpose();
      evidence.vector += weight * tiles[i].inverse_depth * tiles[i].J;
      evidence.inverse_depth += inlier * tiles[i].inverse_depth;
      weights += inlier;
    }
    if (!(weights > 0.0)) return std::nullopt;
    evidence.inverse_depth /= weights;
    state = (evidence.information + prior).ldlt().solve(evidence.vector);
  }
  const double alike = clustering(weighted);
  evidence.information /= alike;
  evidence.vector /= alike;
  return evidence;
}

}  // namespace rgbd_sfm_fusion
