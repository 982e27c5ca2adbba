// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <opencv2/core.hpp>

#include "rgbd_sfm_fusion/fusion/sfm_state.h"

namespace rgbd_sfm_fusion::test {

constexpr double kOverlapAlpha = 2.5;
constexpr int kWindow = 9;  // [px] width in which pixels err alike, as in a stereo match

/// Errors of SfM's inverse depth in an overlap, and the depths of the overlap.
struct OverlapErrors {
  double pixel = 0.02, tile = 0.0;       ///< [1/m] sigma of a window of pixels, and of a tile
  double offset = 0.0;                   ///< [1/m] b
  double tilt_x = 0.0, tilt_y = 0.0;     ///< [1/m] c
  double alpha = kOverlapAlpha;          ///< [m/unit]
  double wild_share = 0.0;               ///< of pixels that are off by 0.2 / m
  double stated = 0.02;                  ///< [1/m] sigma that SfM states
  double nearest = 1.0, farthest = 5.0;  ///< [m]
  std::size_t false_columns = 0;  ///< of tiles, from the left: there the sensor's depth is a tenth too far
};

/// Each tile has its own depth.
inline Overlap makeOverlap(const OverlapErrors& errors, std::uint64_t seed) {
  Overlap overlap;
  cv::RNG random(seed);
  for (std::size_t tile = 0; tile < Overlap::kTiles; ++tile) {
    const double of_tile = random.gaussian(errors.tile);
    const double rho = random.uniform(1.0 / errors.farthest, 1.0 / errors.nearest);
    const double x = -0.5 + static_cast<double>(tile % 8) / 7.0,
                 y = -0.4 + 0.8 * static_cast<double>(tile / 8) / 5.0;
    double of_window = 0.0;
    for (int i = 0; i < 100; ++i) {
      if (i % kWindow == 0) of_window = random.gaussian(errors.pixel);
      const bool wild = random.uniform(0.0, 1.0) < errors.wild_share;
      const double error =
          of_tile + of_window - errors.offset - errors.tilt_x * x - errors.tilt_y * y + (wild ? 0.2 : 0.0);
      const double z = 1.0 / (rho + error);
      overlap.sfm.push_back(static_cast<float>(z / errors.alpha));
      overlap.sfm_variance.push_back(static_cast<float>(std::pow(errors.stated * z * z / errors.alpha, 2)));
      const double factor = tile % 8 < errors.false_columns ? 1.1 : 1.0;
      overlap.sensor.push_back(static_cast<float>(factor / rho));
      overlap.sensor_variance.push_back(1e-8F);
      overlap.x.push_back(static_cast<float>(x));
      overlap.y.push_back(static_cast<float>(y));
      overlap.tile.push_back(static_cast<std::uint8_t>(tile));
    }
  }
  overlap.pixels = overlap.size();
  return overlap;
}

}  // namespace rgbd_sfm_fusion::test
