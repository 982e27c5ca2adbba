// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Deserialises messages. It asks for memory only after it knows that the bytes are there. With
/// ros::serialization::deserialize(), four damaged bytes could ask for 4 GB.
#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <cstdint>
#include <vector>

namespace rgbd_sfm_fusion {

/// @throws std::invalid_argument if the message is shorter than it claims
sensor_msgs::ImagePtr readImage(const std::vector<std::uint8_t>& bytes);

/// As readImage().
sensor_msgs::CompressedImage readCompressedImage(const std::vector<std::uint8_t>& bytes);

/// As readImage().
sensor_msgs::CameraInfo readCameraInfo(const std::vector<std::uint8_t>& bytes);

}  // namespace rgbd_sfm_fusion
