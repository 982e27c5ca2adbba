// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "rgbd_sfm_fusion/completion/depth_cells.h"

namespace rgbd_sfm_fusion {

/// How well neighbouring cells are connected, from 0 (not at all) to 1.
struct CellLinks {
  std::vector<float> right;  ///< of each cell with the one to its right; 0 in the last column
  std::vector<float> below;  ///< of each cell with the one below it; 0 in the last row
};

/// Links by the image: they fall with the distance (e-fold in 60 px) and with the difference of brightness
/// (e-fold in 20 grey levels). What is far in this sense is behind an edge, or of no concern.
/// @param grey  mean of each cell
CellLinks linksOf(const CellGrid& grid, const cv::Mat_<std::uint8_t>& grey);

/// Values of each cell, side by side: kLanes of them.
constexpr int kMomentLanes = 12;
constexpr int kQuadrantLanes = 8;

/// Each cell's values become the sum of all cells', weighted with the product of the links on the way: along
/// the row, then along the column.
/// @param values     kMomentLanes of each cell
/// @param work       of the same size
void sumAlongLinks(const CellGrid& grid, const CellLinks& links, std::vector<float>& values,
                   std::vector<float>& work);

/// The same apart for the cells to the upper left, upper right, lower left and lower right. A cell's own row
/// and column belong to both sides.
/// @param values  kQuadrantLanes of each cell
/// @param sums    four of the same size
void sumQuadrants(const CellGrid& grid, const CellLinks& links, const std::vector<float>& values,
                  std::vector<float> (&sums)[4]);

}  // namespace rgbd_sfm_fusion
