// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "rgbd_sfm_fusion/completion/depth_cells.h"

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

/// Number of values of each cell. They stand side by side.
constexpr int kMomentLanes = 12;
constexpr int kQuadrantLanes = 8;

/// Each cell's values become a weighted sum over the values of all cells. The weight is the product of the
/// links on the way: along the row, then along the column.
/// @param values     kMomentLanes of each cell
/// @param work       of the same size
/// @param fill, use  are called with each row: once before its values are read, and once when its sums are
///                   there; while the row is in the processor's cache
void sumAlongLinks(const CellGrid& grid, const CellLinks& links, std::vector<float>& values,
                   std::vector<float>& work, const std::function<void(int)>& fill,
                   const std::function<void(int)>& use);

/// The same sums, but four of them: over the cells to the upper left, upper right, lower left and lower
/// right. A cell's own row and column belong to both sides.
/// @param values  kQuadrantLanes of each cell
/// @param sums    four of the same size
/// @param fill, use  as above
void sumQuadrants(const CellGrid& grid, const CellLinks& links, const std::vector<float>& values,
                  std::vector<float> (&sums)[4], const std::function<void(int)>& fill,
                  const std::function<void(int)>& use);

}  // namespace rgbd_sfm_fusion
