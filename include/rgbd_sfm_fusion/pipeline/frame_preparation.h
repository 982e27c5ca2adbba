// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "rgbd_sfm_fusion/input/image_conversion.h"
#include "rgbd_sfm_fusion/input/rectification.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// An image as its message has it.
struct RawImage {
  Stamp stamp = kNoStamp;
  std::string encoding;  ///< of sensor_msgs/Image
  cv::Mat pixels;        ///< empty: there is no image
};

/// Brightness and metres, rectified, in memory of its own: the raw images may go.
/// @param depth      may be empty
/// @param saturated  [m] depth that means none; 0: there is no such
/// @throws std::invalid_argument for an encoding that is not accepted, or another size than the calibration's
RgbdFrame prepareFrame(const Rectifier& rectifier, const RawImage& colour, const RawImage& depth,
                       double saturated = 0.0);

/// The depth part of prepareFrame(). Empty for an empty image.
/// @param unit  [m] of a count of 16UC1 and mono16
DepthImage prepareDepth(const Rectifier& rectifier, const RawImage& depth, double unit = kMillimetre,
                        double saturated = 0.0);

}  // namespace rgbd_sfm_fusion
