// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/sensor/depth_noise.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Whether depth has gaps that are too wide for isStray(): most depths have none within 3 px in their row, or
/// in their column.
bool isSparse(const DepthImage& measured);

/// Whether nothing around confirms a depth. Sensors match windows of several pixels, so that depth of a
/// surface comes with more of it, in a row and in a column. Single wild depths lie along contours and in
/// holes: there the image has its edges, so that poses would rest on them, and SfM would be compared with
/// them.
///
/// A depth is confirmed by depth of its own surface (kStepRatio, or 3 sigma) among the nearest depths to the
/// left and right, and among those above and below. They may be up to 3 px away, as depth that is registered
/// to an image of up to three times its size has gaps. Without lateral errors, as in the paper, a depth is of
/// its pixel alone, and no stray.
/// @param measured  [m] as the sensor measured it, also out of range; not sparse
bool isStray(const DepthImage& measured, const cv::Point& pixel, const DepthNoiseModel& noise);

/// Removes depth that isStray(), unless depth is sparse.
/// @param depth  of the same size; NaN where depth is removed
void removeStrays(const DepthImage& measured, const DepthNoiseModel& noise, GaussianDepth* depth);

}  // namespace rgbd_sfm_fusion
