// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/sensor/depth_noise.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Whether nothing around confirms a depth. Sensors match windows of several pixels, so that depth of a
/// surface comes with more of it, in a row and in a column. Single wild depths lie along contours and in
/// holes: there the image has its edges, so that poses would rest on them, and SfM would be compared with
/// them.
///
/// A depth is confirmed by depth of its own surface among the nearest depths to the left and right, and among
/// those above and below. They may be up to 3 px away, as depth that is registered to an image of up to three
/// times its size has gaps. Without lateral errors, as in the paper, a depth is of its pixel alone, and no
/// stray.
/// @param measured  [m] as the sensor measured it, also out of range
bool isStray(const DepthImage& measured, const cv::Point& pixel, const DepthNoiseModel& noise);

/// Removes depth that isStray().
/// @param depth  of the same size; NaN where depth is removed
void removeStrays(const DepthImage& measured, const DepthNoiseModel& noise, GaussianDepth* depth);

}  // namespace rgbd_sfm_fusion
