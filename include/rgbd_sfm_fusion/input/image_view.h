// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>

namespace rgbd_sfm_fusion {

/// No camera with a depth sensor has larger images. A broken message cannot ask for more memory than these
/// limits allow.
constexpr std::int64_t kLongestSide = 8192;    ///< [px]
constexpr std::int64_t kMostPixels = 1 << 24;  ///< [px] of an image

/// @param what  e.g. `image` or `camera_info`
/// @throws std::invalid_argument naming size and limits, unless both sides are 1 to kLongestSide,
///         and the image has at most kMostPixels
void requireUsableSize(const char* what, std::int64_t width, std::int64_t height);

/// The fields of sensor_msgs/Image that describe its pixels. The fields are not trusted before they are
/// checked.
struct ImageBytes {
  std::uint32_t width = 0;     ///< [px]
  std::uint32_t height = 0;    ///< [px]
  std::uint32_t step = 0;      ///< [bytes] from a row to the next
  std::string encoding;        ///< of sensor_msgs/Image
  bool is_big_endian = false;  ///< of values of more than one byte
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;  ///< [bytes] of `data`
};

/// The pixels as an OpenCV image of the encoding's type. The pixels are copied only if the byte order is not
/// this machine's. Otherwise the result is valid as long as `bytes.data`, and must not be written to.
/// @throws std::invalid_argument for an encoding that holds no image, a size that no camera has, or a step or
///         amount of data that is too small
cv::Mat viewPixels(const ImageBytes& bytes);

}  // namespace rgbd_sfm_fusion
