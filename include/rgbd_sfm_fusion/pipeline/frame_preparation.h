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

/// A frame of brightness and metres, rectified. The frame has memory of its own, so the raw images need not
/// be kept.
/// @param depth      may be empty
/// @param saturated  [m] value that means no depth; 0: there is no such value
/// @throws std::invalid_argument for an encoding that is not accepted, or another size than the calibration's
RgbdFrame prepareFrame(const Rectifier& rectifier, const RawImage& colour, const RawImage& depth,
                       double saturated = 0.0);

/// The colour part of prepareFrame().
GreyImage prepareGrey(const Rectifier& rectifier, const RawImage& colour);

/// The depth part of prepareFrame(). Empty for an empty image.
/// @param unit  [m] of a count of 16UC1 and mono16
DepthImage prepareDepth(const Rectifier& rectifier, const RawImage& depth, double unit = kMillimetre,
                        double saturated = 0.0);

}  // namespace rgbd_sfm_fusion
