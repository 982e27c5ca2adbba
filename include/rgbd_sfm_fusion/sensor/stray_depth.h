// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/sensor/depth_noise.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Measured depth, sorted by what the depths around say of it. Strays are depths that nothing around
/// confirms. Sensors match windows of several pixels, so that depth of a surface comes with more of it, in a
/// row and in a column. Single wild depths lie along contours and in holes: there the image has its edges, so
/// that poses would rest on them, and SfM would be compared with them.
///
/// The nearest depths to the left and right of a depth, and those above and below it, are asked whether they
/// are of its surface (kStepRatio, or 3 sigma). One of each pair confirms the depth, else it is a stray. They
/// may be up to 3 px away, as depth that is registered to an image of up to three times its size has gaps.
///
/// A stray that one pair confirms is more often right than wrong (within a tenth: 65 to 86 % in recordings):
/// a thin thing, or a contour that is a pixel off. Of a stray that none confirms, all depths around say that
/// it is wrong, and 6 of 10 to 9 of 10 are. If there are none, nothing is known.
struct SortedDepth {
  DepthImage confirmed;  ///< [m] without strays; NaN = none
  DepthImage credible;   ///< [m] with the strays that are not contradicted by all depths around
};

/// Without lateral errors, as in the paper, a depth is of its pixel alone, and no stray. Nor are there any if
/// most depths have none within 3 px in their row, or in their column. Then both images are `measured`.
/// @param measured  [m] as the sensor measured it, also out of range
/// @param buffer    images of the right size are overwritten and returned, if there may be strays
SortedDepth sortStrays(const DepthImage& measured, const DepthNoiseModel& noise, SortedDepth buffer = {});

/// withNoise() of the confirmed depth. Steps to other credible depth count.
GaussianDepth withNoise(const SortedDepth& depth, const DepthNoiseModel& noise, GaussianDepth buffer = {},
                        cv::Mat_<float>* surface_variance = nullptr);

}  // namespace rgbd_sfm_fusion
