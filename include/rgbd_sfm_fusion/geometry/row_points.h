// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rgbd_sfm_fusion {

/// The pixels of a row that have a depth, side by side, and where a warp takes them.
class RowPoints {
 public:
  explicit RowPoints(int width);

  /// Takes the pixels of a row of the given width that have a depth.
  void gather(const float* row);

  std::size_t count = 0;  ///< of points; the arrays are longer
  std::vector<int> columns;
  std::vector<float> depths;
  std::vector<int> pixels;  ///< of the image that they are taken to; -1 for none
  std::vector<float> z;     ///< depth there

 private:
  int width_;
  std::vector<std::uint8_t> marks_;  ///< 1 where there is a depth
};

}  // namespace rgbd_sfm_fusion
