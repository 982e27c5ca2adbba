// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/sensor/depth_noise.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Sensor depth of a frame without its strays (stray_depth.h), and what is needed to compare SfM's depth with
/// it.
struct SensorDepth {
  GaussianDepth depth;               ///< [m]; NaN = none
  cv::Mat_<float> surface_variance;  ///< [m^2] as if no step were near; empty: the variance of `depth`
  DepthImage of_any_range;   ///< [m] `depth` with values that are nearer or farther than the sensor can
                             ///< measure, at the same stamp; empty: not known
  DepthNoiseModel noise;     ///< of `depth`; depth nearer than `noise.min_range` is no measurement
  DepthImage credible = {};  ///< [m] `of_any_range` with the strays that may be right

  /// Variance of depth on the pixel's own surface.
  const cv::Mat_<float>& surfaceVariance() const {
    return surface_variance.empty() ? depth.variance : surface_variance;
  }
};

}  // namespace rgbd_sfm_fusion
