// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/sensor/depth_noise.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Sensor depth of a frame, with what tells whether SfM's may contradict it.
struct SensorDepth {
  GaussianDepth depth;               ///< [m]; NaN = none
  cv::Mat_<float> surface_variance;  ///< [m^2] as if no step were near; empty: that of `depth`
  DepthImage of_any_range;           ///< [m] with what is nearer or farther than the sensor can measure, at
                                     ///< the stamp of `depth`; empty: not known
  DepthNoiseModel noise;             ///< of it; what is nearer than its range is no measurement

  /// Of the pixel's own surface.
  const cv::Mat_<float>& surfaceVariance() const {
    return surface_variance.empty() ? depth.variance : surface_variance;
  }
};

}  // namespace rgbd_sfm_fusion
