// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "rgbd_sfm_fusion/completion/depth_cells.h"
#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {

/// How well neighbouring cells are connected, from 0 (not at all) to 1.
struct CellLinks {
  std::vector<float> right;  ///< link of each cell to the cell on its right; 0 in the last column
  std::vector<float> below;  ///< link of each cell to the cell below it; 0 in the last row
};

/// [grey levels] Difference of brightness of an edge, which may be a contour.
constexpr int kEdge = 20;

/// Links by the image: they fall with the distance (e-fold in 100 px) and with the difference of brightness
/// (e-fold in kEdge). Cells that are far in this sense are behind an edge, or of no concern.
/// @param grey  mean brightness of each cell
CellLinks linksOf(const CellGrid& grid, const cv::Mat_<std::uint8_t>& grey);

/// Number of values of each cell.
constexpr int kMomentLanes = 12;
constexpr int kQuadrantLanes = 8;

/// Sums over all cells, of several values at once. The weight of a cell is the product of the links on the
/// way: along its row, then along the column.
///
/// A row's values are filled in cell by cell, since sums along a row go from cell to cell, and are used value
/// by value, since what is done with them goes over many cells at once.
class LinkedSums {
 public:
  /// Writes a row's values: those of a cell side by side.
  using Fill = std::function<void(int row, float* values)>;

  /// @param lanes  how many of the values are summed up
  /// @param fill  kMomentLanes of each cell
  /// @param use   gets a row's sums, from the last row to the first: stride() of the first value, one for each
  ///              cell, then of the second
  void overAll(const CellGrid& grid, const CellLinks& links, int lanes, const Fill& fill,
               const std::function<void(int row, const float* sums)>& use);

  /// The same sums, but four of them: over the cells to the upper left, upper right, lower left and lower
  /// right. A cell's own row and column belong to both sides.
  /// @param lanes  how many of the values are summed up
  /// @param fill  kQuadrantLanes of each cell
  /// @param use   gets the sums of each quadrant as above
  void overQuadrants(const CellGrid& grid, const CellLinks& links, int lanes, const Fill& fill,
                     const std::function<void(int row, const std::array<const float*, 4>& sums)>& use);

  /// Cells of a row, rounded up to full blocks (simd.h).
  static std::size_t stride(const CellGrid& grid) {
    return static_cast<std::size_t>(paddedToLanes(grid.columns));
  }

 private:
  std::vector<float> cells_[3];          // of a row, cell by cell
  std::vector<float> rows_[4];           // sums along rows, or of what is above them, value by value
  std::vector<float> row_, from_below_;  // of one row, value by value
};

}  // namespace rgbd_sfm_fusion
