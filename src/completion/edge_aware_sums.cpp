// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/completion/edge_aware_sums.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <opencv2/core/hal/intrin.hpp>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr float kReach = 100.0F;  // [px] of an e-fold

/// Link of two cells by their difference of brightness.
float linkOf(int difference) {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> links{};
    for (std::size_t i = 0; i < links.size(); ++i)
      links[i] = std::exp(-static_cast<float>(CellGrid::kSize) / kReach -
                          static_cast<float>(i) / static_cast<float>(kEdge));
    return links;
  }();
  return table[static_cast<std::size_t>(std::abs(difference))];
}

/// Four values of a cell as a vector: the compiler does not find them by itself.
using Four = float __attribute__((vector_size(16), may_alias, aligned(4)));
static_assert(kMomentLanes % 4 == 0 && kQuadrantLanes % 4 == 0, "a cell's values are vectors of four");

inline Four& fourAt(float* values) {
  return *reinterpret_cast<Four*>(values);
}
inline Four fourAt(const float* values) {
  return *reinterpret_cast<const Four*>(values);
}

/// Sums along a row in both directions at once, as one would wait for its last step. Those from the left
/// contain the cell itself.
/// @param values  `Lanes` of each cell, as the results
template <int Lanes, bool FromRightWithOwn>
inline void sumRow(const float* values, const float* links, int columns, float* __restrict from_left,
                   float* __restrict from_right) {
  constexpr std::size_t kFours = Lanes / 4;
  Four rightwards[kFours] = {}, leftwards[kFours] = {};
  for (int i = 0; i < columns; ++i) {
    const int x = i, from_end = columns - 1 - i;
    const float link = x > 0 ? links[x - 1] : 0.0F;
    for (int k = 0; k < Lanes; k += 4) {
      Four& carried = rightwards[k / 4];
      carried = fourAt(values + Lanes * x + k) + link * carried;
      fourAt(from_left + Lanes * x + k) = carried;
    }
    for (int k = 0; k < Lanes; k += 4) {
      Four& carried = leftwards[k / 4];
      const Four others = links[from_end] * carried;
      carried = fourAt(values + Lanes * from_end + k) + others;
      fourAt(from_right + Lanes * from_end + k) = FromRightWithOwn ? carried : others;
    }
  }
}

/// From cell by cell to value by value. `at(i)` gives four values of a cell.
/// @param used  how many values are needed; more may be written
template <int Lanes, typename Values>
inline void toLanes(const Values& at, int used, int columns, int stride, float* __restrict lanes) {
  for (int x = 0; x < columns; x += 4) {
    for (int k = 0; k < used; k += 4) {
      cv::v_float32x4 of[4];
      cv::v_transpose4x4(at(Lanes * x + k), at(Lanes * (x + 1) + k), at(Lanes * (x + 2) + k),
                         at(Lanes * (x + 3) + k), of[0], of[1], of[2], of[3]);
      for (int i = 0; i < 4; ++i) cv::v_store(lanes + stride * (k + i) + x, of[i]);
    }
  }
}

RGBD_SFM_FUSION_MULTIVERSION
void sumRowOfMoments(const float* values, const float* links, int lanes, int columns, int stride,
                     float* __restrict from_left, float* __restrict from_right, float* __restrict sums) {
  sumRow<kMomentLanes, false>(values, links, columns, from_left, from_right);
  toLanes<kMomentLanes>([&](int i) { return cv::v_load(from_left + i) + cv::v_load(from_right + i); }, lanes,
                        columns, stride, sums);
}

RGBD_SFM_FUSION_MULTIVERSION
void sumRowOfQuadrants(const float* values, const float* links, int lanes, int columns, int stride,
                       float* __restrict from_left, float* __restrict from_right, float* __restrict left_sums,
                       float* __restrict right_sums) {
  sumRow<kQuadrantLanes, true>(values, links, columns, from_left, from_right);
  toLanes<kQuadrantLanes>([&](int i) { return cv::v_load(from_left + i); }, lanes, columns, stride,
                          left_sums);
  toLanes<kQuadrantLanes>([&](int i) { return cv::v_load(from_right + i); }, lanes, columns, stride,
                          right_sums);
}

/// One step from row to row, value by value: sum = values + link * before. `sum` may be `values`.
RGBD_SFM_FUSION_MULTIVERSION
void addLinked(const float* values, const float* links, const float* before, int lanes, int columns,
               int stride, float* sum) {
  for (int first = 0; first < lanes * stride; first += stride) {
    for (int x = 0; x < columns; ++x) sum[first + x] = values[first + x] + links[x] * before[first + x];
  }
}

/// One step upwards: adds the row to the sum from below, and that sum without the row to the one from above.
RGBD_SFM_FUSION_MULTIVERSION
void mergeFromBelow(const float* values, const float* from_above, const float* links, int lanes, int columns,
                    int stride, float* __restrict from_below, float* __restrict sum) {
  for (int first = 0; first < lanes * stride; first += stride) {
    for (int x = 0; x < columns; ++x) {
      const float others = links[x] * from_below[first + x];
      from_below[first + x] = values[first + x] + others;
      sum[first + x] = from_above[first + x] + others;
    }
  }
}

/// Vectors never shrink: both kinds of sums use them in turn, and what is added would be filled with zeros.
void makeRoom(std::size_t size, std::vector<float>& values) {
  if (values.size() < size) values.resize(size);
}

}  // namespace

CellLinks linksOf(const CellGrid& grid, const cv::Mat_<std::uint8_t>& grey) {
  CellLinks links;
  links.right.assign(grid.size(), 0.0F);
  links.below.assign(grid.size(), 0.0F);
  for (int row = 0; row < grid.rows; ++row) {
    const std::uint8_t* here = grey[row];
    const std::uint8_t* below = grey[std::min(row + 1, grid.rows - 1)];
    float* right_links = links.right.data() + grid.index(row, 0);
    float* below_links = links.below.data() + grid.index(row, 0);
    for (int x = 0; x + 1 < grid.columns; ++x) right_links[x] = linkOf(here[x + 1] - here[x]);
    if (row + 1 == grid.rows) break;
    for (int x = 0; x < grid.columns; ++x) below_links[x] = linkOf(below[x] - here[x]);
  }
  return links;
}

void LinkedSums::overAll(const CellGrid& grid, const CellLinks& links, int lanes, const Fill& fill,
                         const std::function<void(int, const float*)>& use) {
  const std::size_t padded = stride(grid), size = kMomentLanes * padded;
  for (std::vector<float>& cells : cells_) cells.resize(size);
  for (std::size_t i = 0; i < 2; ++i) makeRoom(size * static_cast<std::size_t>(grid.rows), rows_[i]);
  row_.resize(size);
  from_below_.assign(size, 0.0F);
  const auto at = [&](std::size_t i, int y) { return rows_[i].data() + size * static_cast<std::size_t>(y); };
  const auto columns = grid.columns, distance = static_cast<int>(padded);
  for (int y = 0; y < grid.rows; ++y) {
    fill(y, cells_[0].data());
    sumRowOfMoments(cells_[0].data(), links.right.data() + grid.index(y, 0), lanes, columns, distance,
                    cells_[1].data(), cells_[2].data(), at(0, y));
    if (y == 0) {
      std::copy_n(at(0, 0), size, at(1, 0));
    } else {
      addLinked(at(0, y), links.below.data() + grid.index(y - 1, 0), at(1, y - 1), lanes, columns, distance,
                at(1, y));
    }
  }
  for (int y = grid.rows - 1; y >= 0; --y) {
    mergeFromBelow(at(0, y), at(1, y), links.below.data() + grid.index(y, 0), lanes, columns, distance,
                   from_below_.data(), row_.data());
    use(y, row_.data());
  }
}

void LinkedSums::overQuadrants(const CellGrid& grid, const CellLinks& links, int lanes, const Fill& fill,
                               const std::function<void(int, const std::array<const float*, 4>&)>& use) {
  const std::size_t padded = stride(grid), size = kQuadrantLanes * padded;
  for (std::vector<float>& cells : cells_) cells.resize(size);
  for (std::vector<float>& rows : rows_) makeRoom(size * static_cast<std::size_t>(grid.rows), rows);
  const auto at = [&](std::size_t i, int y) { return rows_[i].data() + size * static_cast<std::size_t>(y); };
  const auto columns = grid.columns, distance = static_cast<int>(padded);
  // The sums along a row come first, and are stored in the lower quadrants.
  for (int y = 0; y < grid.rows; ++y) {
    fill(y, cells_[0].data());
    sumRowOfQuadrants(cells_[0].data(), links.right.data() + grid.index(y, 0), lanes, columns, distance,
                      cells_[1].data(), cells_[2].data(), at(2, y), at(3, y));
    for (std::size_t side = 0; side < 2; ++side) {
      if (y == 0) {
        std::copy_n(at(side + 2, 0), size, at(side, 0));
      } else {
        addLinked(at(side + 2, y), links.below.data() + grid.index(y - 1, 0), at(side, y - 1), lanes, columns,
                  distance, at(side, y));
      }
    }
  }
  for (int y = grid.rows - 1; y >= 0; --y) {
    for (std::size_t side = 2; side < 4 && y + 1 < grid.rows; ++side)
      addLinked(at(side, y), links.below.data() + grid.index(y, 0), at(side, y + 1), lanes, columns, distance,
                at(side, y));
    use(y, {at(0, y), at(1, y), at(2, y), at(3, y)});
  }
}

}  // namespace rgbd_sfm_fusion
