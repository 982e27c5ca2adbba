// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

namespace rgbd_sfm_fusion {

/// Bands of an image's rows: every `parts`-th band, from band `part` on.
struct RowBands {
  static constexpr int kRows = 32;  ///< of a band, from the top; the last band may have fewer

  int part = 0, parts = 1;

  static RowBands all() { return {}; }

  bool has(int band) const { return band % parts == part; }

  /// Calls `visit(first row, row behind the last)` for each band of an image with so many rows.
  template <class Visit>
  void forEach(int rows, const Visit& visit) const {
    for (int first = part * kRows; first < rows; first += parts * kRows)
      visit(first, std::min(first + kRows, rows));
  }
};

}  // namespace rgbd_sfm_fusion
