// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// What a pixel with both depths says of its area, bit by bit.
constexpr int kBoth = 1, kAgainst = 2;

/// What is said of areas, by cells of 4 x 4 px; not 0 where it holds.
struct AreaVerdicts {
  static constexpr int kCell = 4;  ///< [px]

  /// Two fifths of the pixels with both depths, 12 at least, in the area of 20 x 20 px around a cell are
  /// against their being one; or in that of a cell beside it, since sensor depth is not seen from where the
  /// colour is, nor at the same time.
  cv::Mat_<std::uint8_t> contested;
  /// Fewer than 12 pixels of that area have both depths, but some have.
  cv::Mat_<std::uint8_t> sparse;
};

/// @param votes  H x W, of kBoth and kAgainst
AreaVerdicts judgeAreas(const cv::Mat_<std::uint8_t>& votes);

/// Calls settle(x, y) for each pixel of an image in the cells that are not 0.
template <typename Settle>
void forEachPixel(const cv::Mat_<std::uint8_t>& cells, const cv::Size& size, const Settle& settle) {
  constexpr int kCell = AreaVerdicts::kCell;
  const cv::Rect image({0, 0}, size);
  for (int row = 0; row < cells.rows; ++row) {
    for (int column = 0; column < cells.cols; ++column) {
      if (cells(row, column) == 0) continue;
      const cv::Rect pixels = cv::Rect(column * kCell, row * kCell, kCell, kCell) & image;
      for (int y = pixels.y; y < pixels.br().y; ++y) {
        for (int x = pixels.x; x < pixels.br().x; ++x) settle(x, y);
      }
    }
  }
}

}  // namespace rgbd_sfm_fusion
