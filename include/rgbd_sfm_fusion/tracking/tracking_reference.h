// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/rolling_shutter.h"

namespace rgbd_sfm_fusion {

/// Keyframe pixels of one pyramid level that have a depth and a gradient: one array per quantity, padded to
/// full blocks with points that are never in view. The arrays may be longer.
struct ReferencePoints {
  PinholeCamera camera;              ///< of the level
  int count = 0;                     ///< points before padding
  std::vector<int> ends;             ///< per band of rows of the full image: one past its last point
  std::vector<float> x, y;           ///< ray (x, y, 1) of the pixel, in the keyframe at its middle row
  std::vector<float> inverse_depth;  ///< [1 / tracker unit]
  std::vector<float> inverse_depth_variance;
  std::vector<float> intensity;               ///< [grey levels]
  std::vector<float> gradient_x, gradient_y;  ///< [grey levels / px of the level]

  /// 0 if there are no points.
  double meanInverseDepth() const {
    const double sum = std::accumulate(inverse_depth.begin(), inverse_depth.begin() + count, 0.0);
    return sum / std::max(count, 1);
  }

  /// ReadoutMotion::share() of the row of the point in the middle of [begin, end), or of the last point
  /// before it.
  double shareInMiddle(int begin, int end) const {
    if (count == 0) return 0.0;
    const auto middle = static_cast<std::size_t>(std::min(begin + (end - begin) / 2, count - 1));
    return ReadoutMotion::share(camera.fy * static_cast<double>(y[middle]) + camera.cy, camera.height);
  }
};

/// The data that frames are aligned with: the keyframe's brightness and depth, per pyramid level.
/// TrackingCandidates collect it.
struct TrackingReference {
  std::vector<ReferencePoints> by_level;  ///< empty points on levels that are finer than tracking's finest
  /// Of the variance of a point's inverse depth: what is the point's own, and not its neighbours' as well.
  float independent_share = 1.0F;

  const ReferencePoints& points(int level) const { return by_level[static_cast<std::size_t>(level)]; }
  int levels() const { return static_cast<int>(by_level.size()); }
};

/// A copy in as little memory as it takes, to be kept. The original has room for all candidates.
TrackingReference compactCopy(const TrackingReference& reference);

}  // namespace rgbd_sfm_fusion
