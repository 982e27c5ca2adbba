// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

namespace rgbd_sfm_fusion {

bool isPng(const std::uint8_t* data, std::size_t size);
bool isJpeg(const std::uint8_t* data, std::size_t size);

struct ImageSize {
  std::int64_t width = 0, height = 0;  ///< [px]
};

/// The size that the file's header states. Nothing is decoded.
/// @throws std::invalid_argument for a header that is cut off or broken, a JPEG without its end, and one with
///         more passes over the image than any encoder makes
ImageSize pngSize(const std::uint8_t* data, std::size_t size);
ImageSize jpegSize(const std::uint8_t* data, std::size_t size);

}  // namespace rgbd_sfm_fusion
