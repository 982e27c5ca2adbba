// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>

namespace rgbd_sfm_fusion {

/// The fields of sensor_msgs/CompressedImage, as image_transport's `compressed` and `compressedDepth` send
/// it. The fields are not trusted before they are checked.
struct CompressedBytes {
  std::string format;  ///< e.g. `rgb8; jpeg compressed bgr8`, `png`, `16UC1; compressedDepth`
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;  ///< [bytes] of `data`
};

struct DecodedImage {
  std::string encoding;  ///< of sensor_msgs/Image
  cv::Mat pixels;        ///< H x W, of the type that the encoding names, in memory of its own
};

/// Decodes JPEG and PNG, and the depth of `compressedDepth`, which is PNG or RVL. Depth in 16UC1 stays as it
/// is. Depth in 32FC1 is in metres, with NaN where there is no depth. An image with one channel of 16 bits is
/// called mono16, which is accepted as depth, too.
/// @throws std::invalid_argument naming what was found and what was expected: for another format, for data
///         that are cut off or broken, and for sizes that no camera has. Such sizes are refused before
///         anything is decoded
DecodedImage decodeImage(const CompressedBytes& bytes);

}  // namespace rgbd_sfm_fusion
