// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

constexpr double kMillimetre = 1e-3;  ///< [m]

/// Sensor depth as the package uses it: metres; NaN where nothing was measured.
/// @param raw       H x W
/// @param encoding  of sensor_msgs/Image: 16UC1 or mono16 (counts, 0 = none),
///                  or 32FC1 (m; NaN, ±Inf, 0 and less = none)
/// @param unit       [m] per count
/// @param saturated  [m] depth of the sensor's highest code, which becomes NaN; 0: there is no such code
/// @throws std::invalid_argument for another encoding, listing these, or if `raw` is not of the encoding's
/// type
DepthImage toDepthImage(const cv::Mat& raw, const std::string& encoding, double unit = kMillimetre,
                        double saturated = 0.0);

/// Brightness of a colour image. Images in mono8 and 8UC1 are returned uncopied.
/// @param raw       H x W
/// @param encoding  of sensor_msgs/Image: mono, rgb(a) and bgr(a) of 8 or 16 bits, bayer, yuv422;
///                  8UC1 is taken for mono8, 8UC3 for bgr8 and 8UC4 for bgra8
/// @throws std::invalid_argument for another encoding, listing these, or if `raw` is not of the encoding's
/// type
GreyImage toGreyImage(const cv::Mat& raw, const std::string& encoding);

}  // namespace rgbd_sfm_fusion
