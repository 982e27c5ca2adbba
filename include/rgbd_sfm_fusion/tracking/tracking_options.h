// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

namespace rgbd_sfm_fusion {

/// Direct image alignment (method.md 7).
struct TrackingOptions {
  int pyramid_levels = 5;        ///< number of levels: full resolution, and its halvings
  int finest_level = 0;          ///< the level that alignment ends on; 0 is full resolution
  float image_noise = 4.0F;      ///< [grey levels] largest sigma of a pixel, unless the image alone has more
  float min_gradient = 1.5F;     ///< [grey levels / px] least gradient of a keyframe pixel that is tracked
  float huber_threshold = 1.5F;  ///< [σ] larger residuals count linearly
  int max_iterations = 30;       ///< on each level
  float min_share_of_good_points = 0.5F;  ///< of the points in view; with fewer, tracking is lost

  /// The level in the middle of the pyramid. What is learned beside the pose is learned there: it has
  /// fewer points than finer ones, and noise, and what is left of a pose's error, count less.
  int middleLevel() const { return std::max((pyramid_levels - 1) / 2, finest_level); }
};

}  // namespace rgbd_sfm_fusion
