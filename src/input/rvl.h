// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>

namespace rgbd_sfm_fusion {

/// Decodes depth in RVL. The data are lengths of runs, in turn without and with depth. The length of a run
/// with depth is followed by the run's depths, each as the difference to the depth before. A number is a
/// sequence of nibbles, the lowest bits first. A nibble has 3 bits of the number, and one bit that says
/// whether more nibbles follow. Eight nibbles are a little-endian word. Wilson, Fast Lossless Depth Image
/// Compression (2017).
/// @param data  columns and rows as 32-bit little-endian integers, then the words
/// @return H x W, CV_16UC1
/// @throws std::invalid_argument for a size that no camera has, and for data that end early or hold too much
cv::Mat decodeRvl(const std::uint8_t* data, std::size_t size);

}  // namespace rgbd_sfm_fusion
