// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Pixels that have both depths: the paper's V, or an even sample of it. One entry per pixel in each array.
struct Overlap {
  static constexpr int kTileColumns = 8;
  static constexpr int kTileRows = 6;
  static constexpr std::size_t kTiles = kTileColumns * kTileRows;

  std::vector<float> sfm;              ///< μ, tracker units
  std::vector<float> sfm_variance;     ///< σ², tracker units squared
  std::vector<float> sensor;           ///< d [m]
  std::vector<float> sensor_variance;  ///< [m^2]
  std::vector<std::uint8_t> tile;      ///< of the image, row by row
  std::size_t pixels = 0;              ///< [px] |V|, estimated where the arrays are a sample

  std::size_t size() const { return sfm.size(); }
};

/// @param max_samples  about how many of the pixels to take at most, at least a fourth of it; 0 = all
Overlap collectOverlap(const GaussianDepth& sfm, const GaussianDepth& sensor, std::size_t max_samples);

/// Real over stated variance of SfM depth at scale `alpha`, as the sensor shows it: from the median of
/// (d - αμ)² / (σ_d² + α²σ² + (αμ)⁴σ_shared²), which outliers do not move, where the sensor is the better of
/// the two. Pixels that the sensor does not see are taken to be like those it sees.
/// @param shared_sigma  [1/m] sharedInverseDepthSigma(), which is not part of the factor
/// @return within [1/4, 100]; NaN where there are fewer than `min_pixels` such pixels
double sfmVarianceFactor(const Overlap& overlap, double alpha, std::size_t min_pixels,
                         double shared_sigma = 0.0);

/// [1/m] Robust standard deviation, over the image's tiles, of their median difference in inverse depth
/// between SfM at scale `alpha` and the sensor. An error of the poses (a turn taken for a move) shifts all
/// inverse depths of a region alike, which no pixel's variance tells, and which is worst far away.
/// @return NaN where too few tiles have both depths
double sharedInverseDepthSigma(const Overlap& overlap, double alpha);

}  // namespace rgbd_sfm_fusion
