// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>

namespace rgbd_sfm_fusion {

/// Depth in RVL: lengths of runs without and with depth in turn, the latter followed by differences to the
/// depth before. All numbers are in nibbles of 3 bits and one that says whether more follow, the lowest bits
/// first; eight nibbles are a little-endian word. Wilson, Fast Lossless Depth Image Compression (2017).
/// @param data  columns and rows as 32-bit little-endian integers, then the words
/// @return H x W, CV_16UC1
/// @throws std::invalid_argument for a size that is no camera's, and data that end early or hold too much
cv::Mat decodeRvl(const std::uint8_t* data, std::size_t size);

}  // namespace rgbd_sfm_fusion
