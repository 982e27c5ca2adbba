// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace rgbd_sfm_fusion {

constexpr int kSquare = 16;  ///< [px] side of the squares that an image is divided into

/// One value for each square of an image, row by row. The last ones may be cut off.
inline cv::Size squaresOf(const cv::Size& image) {
  return {(image.width + kSquare - 1) / kSquare, (image.height + kSquare - 1) / kSquare};
}

/// Calls action(rectangle) for each square of an image that is marked.
/// @param marks  squaresOf(image), not 0 where marked; or empty
template <class Action>
void forEachMarked(const cv::Mat_<std::uint8_t>& marks, const cv::Size& image, const Action& action) {
  for (int row = 0; row < marks.rows; ++row) {
    for (int column = 0; column < marks.cols; ++column) {
      if (marks(row, column) != 0)
        action(cv::Rect(column * kSquare, row * kSquare, kSquare, kSquare) & cv::Rect({0, 0}, image));
    }
  }
}

}  // namespace rgbd_sfm_fusion
