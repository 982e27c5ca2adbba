// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/completion/edge_aware_sums.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

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

/// A cell's moments as vectors: the compiler does not find them by itself.
using Eight = float __attribute__((vector_size(32), may_alias, aligned(4)));
using Four = float __attribute__((vector_size(16), may_alias, aligned(4)));
static_assert(kMomentLanes == 8 + 4, "a cell's moments are two vectors");

RGBD_SFM_FUSION_MULTIVERSION
void sumRowOfMoments(const float* links, int columns, float* values, float* work) {
  Eight carried8{};
  Four carried4{};
  for (int x = 0; x < columns; ++x) {
    float* const in = values + kMomentLanes * x;
    const float link = x > 0 ? links[x - 1] : 0.0F;
    carried8 = *reinterpret_cast<Eight*>(in) + link * carried8;
    carried4 = *reinterpret_cast<Four*>(in + 8) + link * carried4;
    *reinterpret_cast<Eight*>(work + kMomentLanes * x) = carried8;
    *reinterpret_cast<Four*>(work + kMomentLanes * x + 8) = carried4;
  }
  carried8 = Eight{};
  carried4 = Four{};
  for (int x = columns - 1; x >= 0; --x) {
    float* const in = values + kMomentLanes * x;
    float* const from_left = work + kMomentLanes * x;
    const Eight from_right8 = links[x] * carried8;
    const Four from_right4 = links[x] * carried4;
    carried8 = *reinterpret_cast<Eight*>(in) + from_right8;
    carried4 = *reinterpret_cast<Four*>(in + 8) + from_right4;
    *reinterpret_cast<Eight*>(in) = *reinterpret_cast<Eight*>(from_left) + from_right8;
    *reinterpret_cast<Four*>(in + 8) = *reinterpret_cast<Four*>(from_left + 8) + from_right4;
  }
}

/// One step from row to row: sum = values + link * before, with `Lanes` values in each cell.
template <int Lanes>
inline void addLinked(const float* values, const float* links, const float* before, int columns,
                      float* __restrict sum) {
  for (int x = 0; x < columns; ++x) {
    for (int k = 0; k < Lanes; ++k)
      sum[Lanes * x + k] = values[Lanes * x + k] + links[x] * before[Lanes * x + k];
  }
}

RGBD_SFM_FUSION_MULTIVERSION
void addLinkedMoments(const float* values, const float* links, const float* before, int columns,
                      float* __restrict sum) {
  addLinked<kMomentLanes>(values, links, before, columns, sum);
}

/// The same step, but the sum replaces the values.
RGBD_SFM_FUSION_MULTIVERSION
void addFromBelow(const float* below, const float* links, int columns, float* __restrict values) {
  for (int x = 0; x < columns; ++x) {
    for (int k = 0; k < kQuadrantLanes; ++k)
      values[kQuadrantLanes * x + k] += links[x] * below[kQuadrantLanes * x + k];
  }
}

RGBD_SFM_FUSION_MULTIVERSION
void addLinkedQuadrants(const float* values, const float* links, const float* before, int columns,
                        float* __restrict sum) {
  addLinked<kQuadrantLanes>(values, links, before, columns, sum);
}

/// One step upwards: adds the row to `carried`, and replaces the row by the sum from above and from below.
RGBD_SFM_FUSION_MULTIVERSION
void mergeFromBelow(const float* __restrict from_above, const float* __restrict links, int columns,
                    float* __restrict values, float* __restrict carried) {
  for (int x = 0; x < columns; ++x) {
    for (int k = kMomentLanes * x; k < kMomentLanes * (x + 1); ++k) {
      const float from_below = links[x] * carried[k];
      carried[k] = values[k] + from_below;
      values[k] = from_above[k] + from_below;
    }
  }
}

RGBD_SFM_FUSION_MULTIVERSION
void sumRowRightwards(const float* values, const float* links, int columns, float* __restrict sum) {
  for (int k = 0; k < kQuadrantLanes; ++k) sum[k] = values[k];
  for (int x = 1; x < columns; ++x) {
    for (int k = 0; k < kQuadrantLanes; ++k)
      sum[kQuadrantLanes * x + k] =
          values[kQuadrantLanes * x + k] + links[x - 1] * sum[kQuadrantLanes * (x - 1) + k];
  }
}

RGBD_SFM_FUSION_MULTIVERSION
void sumRowLeftwards(const float* values, const float* links, int columns, float* __restrict sum) {
  float carried[kQuadrantLanes] = {};
  for (int x = columns - 1; x >= 0; --x) {
    for (int k = 0; k < kQuadrantLanes; ++k) {
      carried[k] = values[kQuadrantLanes * x + k] + links[x] * carried[k];
      sum[kQuadrantLanes * x + k] = carried[k];
    }
  }
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

void sumAlongLinks(const CellGrid& grid, const CellLinks& links, std::vector<float>& values,
                   std::vector<float>& work, const std::function<void(int)>& fill,
                   const std::function<void(int)>& use) {
  const auto lanes = static_cast<std::size_t>(kMomentLanes);
  const auto row = [&](std::vector<float>& image, int y) { return image.data() + lanes * grid.index(y, 0); };
  for (int y = 0; y < grid.rows; ++y) {
    fill(y);
    sumRowOfMoments(links.right.data() + grid.index(y, 0), grid.columns, row(values, y), row(work, y));
    if (y == 0) {
      std::copy(row(values, 0), row(values, 0) + lanes * grid.index(1, 0), row(work, 0));
    } else {
      addLinkedMoments(row(values, y), links.below.data() + grid.index(y - 1, 0), row(work, y - 1),
                       grid.columns, row(work, y));
    }
  }
  std::vector<float> carried(lanes * grid.index(1, 0), 0.0F);
  for (int y = grid.rows - 1; y >= 0; --y) {
    mergeFromBelow(row(work, y), links.below.data() + grid.index(y, 0), grid.columns, row(values, y),
                   carried.data());
    use(y);
  }
}

void sumQuadrants(const CellGrid& grid, const CellLinks& links, const std::vector<float>& values,
                  std::vector<float> (&sums)[4], const std::function<void(int)>& fill,
                  const std::function<void(int)>& use) {
  const auto lanes = static_cast<std::size_t>(kQuadrantLanes);
  for (std::vector<float>& sum : sums) sum.resize(values.size());
  const auto at = [&](int y) { return lanes * grid.index(y, 0); };
  // The sums along a row come first, and are stored in the lower quadrants.
  for (int y = 0; y < grid.rows; ++y) {
    fill(y);
    const float* right_links = links.right.data() + grid.index(y, 0);
    sumRowRightwards(values.data() + at(y), right_links, grid.columns, sums[2].data() + at(y));
    sumRowLeftwards(values.data() + at(y), right_links, grid.columns, sums[3].data() + at(y));
    for (std::size_t side = 0; side < 2; ++side) {
      float *above = sums[side].data(), *below = sums[side + 2].data();
      if (y == 0) {
        std::copy(below, below + at(1), above);
      } else {
        addLinkedQuadrants(below + at(y), links.below.data() + grid.index(y - 1, 0), above + at(y - 1),
                           grid.columns, above + at(y));
      }
    }
  }
  for (int y = grid.rows - 1; y >= 0; --y) {
    for (std::size_t side = 2; side < 4 && y + 1 < grid.rows; ++side) {
      float* below = sums[side].data();
      addFromBelow(below + at(y + 1), links.below.data() + grid.index(y, 0), grid.columns, below + at(y));
    }
    use(y);
  }
}

}  // namespace rgbd_sfm_fusion
