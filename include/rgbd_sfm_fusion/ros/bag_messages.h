// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Messages out of their bytes. Unlike ros::serialization::deserialize(), no memory is asked for before it is
/// known that the bytes are there: four damaged ones would ask for 4 GB.
#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <cstdint>
#include <vector>

namespace rgbd_sfm_fusion {

/// @throws std::invalid_argument where the message is shorter than what it claims to hold
sensor_msgs::ImagePtr readImage(const std::vector<std::uint8_t>& bytes);

/// As readImage().
sensor_msgs::CompressedImage readCompressedImage(const std::vector<std::uint8_t>& bytes);

/// As readImage().
sensor_msgs::CameraInfo readCameraInfo(const std::vector<std::uint8_t>& bytes);

}  // namespace rgbd_sfm_fusion
