// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Reads messages as a bag holds them. The first byte says whether it is a colour image, a depth image or a
/// camera_info. Only std::invalid_argument may be thrown.
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "rgbd_sfm_fusion/input/image_conversion.h"
#include "rgbd_sfm_fusion/input/rectification.h"
#include "rgbd_sfm_fusion/ros/bag_messages.h"
#include "rgbd_sfm_fusion/ros/conversions.h"

using namespace rgbd_sfm_fusion;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::vector<std::uint8_t> bytes(data + 1, data + size);
  try {
    if (data[0] % 3 == 2) {
      const Rectifier rectifier(toCalibration(readCameraInfo(bytes)));
      return 0;
    }
    const sensor_msgs::ImageConstPtr image = readImage(bytes);
    if (data[0] % 3 == 0) {
      toGreyImage(viewImage(image), image->encoding);
    } else {
      toDepthImage(viewImage(image), image->encoding);
    }
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
