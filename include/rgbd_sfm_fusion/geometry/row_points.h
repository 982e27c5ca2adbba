// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace rgbd_sfm_fusion {

/// The pixels of a row that have a value (a depth, an inverse depth, a mark), stored side by side, and the
/// places to which a warp takes these pixels.
class RowPoints {
 public:
  explicit RowPoints(int width);

  /// Takes those pixels of a row that have a value above 0. The row has the width given to the constructor.
  void gather(const float* row);

  /// Takes these pixels from some parts of the row. They begin at multiples of eight.
  void gather(const float* row, const std::vector<cv::Range>& parts);

  /// Writes the columns of these pixels to `found` instead, and up to eight values more, which mean nothing.
  /// @return the number of pixels
  std::size_t find(const float* row, int* found);

  std::size_t count = 0;  ///< number of points; the arrays are longer
  std::vector<int> columns;
  std::vector<float> values;
  std::vector<int> pixels;  ///< index in the image to which the warp takes the points; -1 for none
  std::vector<float> z;     ///< depth in that image

 private:
  int width_;
  std::vector<std::uint8_t> marks_;  ///< 1 where there is a value
};

/// Writes the places of the marks that are 1, and up to eight values more, which mean nothing.
/// @param marks  0 or 1 from `begin` on; 0 beyond `end`, up to the next multiple of eight from `begin`
/// @return how many marks are 1
int findMarks(const std::uint8_t* marks, int begin, int end, int* places);

}  // namespace rgbd_sfm_fusion
