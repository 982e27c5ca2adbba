// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/completion/edge_aware_sums.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>

namespace rgbd_sfm_fusion {
namespace {

/// Links and values of a small grid, at random.
struct Example {
  CellGrid grid{cv::Size(27, 22)};
  CellLinks links;
  std::vector<float> moments, values;

  Example() {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
    cv::Mat_<std::uint8_t> grey(grid.rows, grid.columns);
    for (std::uint8_t& value : grey) value = static_cast<std::uint8_t>(40.0F * uniform(random));
    links = linksOf(grid, grey);
    moments.resize(grid.size() * kMomentLanes);
    values.resize(grid.size() * kQuadrantLanes);
    for (float& value : moments) value = uniform(random);
    for (float& value : values) value = uniform(random);
  }

  /// Product of the links along the row of `from`, then along the column of `to`.
  double weight(const cv::Point& from, const cv::Point& to) const {
    double product = 1.0;
    for (int x = std::min(from.x, to.x); x < std::max(from.x, to.x); ++x)
      product *= static_cast<double>(links.right[grid.index(from.y, x)]);
    for (int y = std::min(from.y, to.y); y < std::max(from.y, to.y); ++y)
      product *= static_cast<double>(links.below[grid.index(y, to.x)]);
    return product;
  }

  /// Weighted sum of one of the `lanes` values, over the cells that `counts` accepts.
  template <typename Predicate>
  double sum(const std::vector<float>& of, int lanes, int lane, const cv::Point& to, Predicate counts) const {
    double total = 0.0;
    for (int y = 0; y < grid.rows; ++y) {
      for (int x = 0; x < grid.columns; ++x) {
        const auto at = grid.index(y, x) * static_cast<std::size_t>(lanes) + static_cast<std::size_t>(lane);
        if (counts(cv::Point(x, y))) total += weight({x, y}, to) * static_cast<double>(of[at]);
      }
    }
    return total;
  }
};

/// Gives LinkedSums the values of a row.
LinkedSums::Fill filling(const CellGrid& grid, const std::vector<float>& values, int lanes) {
  return [&grid, &values, lanes](int row, float* to) {
    const auto at = [&](int y) { return values.data() + static_cast<std::size_t>(lanes) * grid.index(y, 0); };
    std::copy(at(row), at(row + 1), to);
  };
}

TEST(EdgeAwareSums, AreThoseOfAllCellsWeightedByTheLinksOnTheWay) {
  const Example example;
  const std::size_t stride = LinkedSums::stride(example.grid);
  LinkedSums sums;
  int used = 0;
  sums.overAll(example.grid, example.links, kMomentLanes,
               filling(example.grid, example.moments, kMomentLanes), [&](int y, const float* of_row) {
                 ++used;
                 for (int x = 0; x < example.grid.columns; ++x) {
                   for (const int lane : {0, 5, 11}) {
                     const double expected = example.sum(example.moments, kMomentLanes, lane, {x, y},
                                                         [](const cv::Point&) { return true; });
                     const float found =
                         of_row[stride * static_cast<std::size_t>(lane) + static_cast<std::size_t>(x)];
                     EXPECT_NEAR(static_cast<double>(found), expected, 1e-4 * expected)
                         << x << ' ' << y << ' ' << lane;
                   }
                 }
               });
  EXPECT_EQ(used, example.grid.rows);
}

TEST(EdgeAwareSums, QuadrantsAreThoseOfEachSide) {
  const Example example;
  const std::size_t stride = LinkedSums::stride(example.grid);
  LinkedSums sums;
  int used = 0;
  sums.overQuadrants(
      example.grid, example.links, kQuadrantLanes, filling(example.grid, example.values, kQuadrantLanes),
      [&](int y, const std::array<const float*, 4>& of_row) {
        ++used;
        for (int x = 0; x < example.grid.columns; ++x) {
          for (std::size_t quadrant = 0; quadrant < 4; ++quadrant) {
            const bool right = quadrant % 2 == 1, below = quadrant / 2 == 1;
            const double expected =
                example.sum(example.values, kQuadrantLanes, 2, {x, y}, [&](const cv::Point& from) {
                  return (right ? from.x >= x : from.x <= x) && (below ? from.y >= y : from.y <= y);
                });
            const float found = of_row[quadrant][stride * 2 + static_cast<std::size_t>(x)];
            EXPECT_NEAR(static_cast<double>(found), expected, 1e-4 * expected) << x << ' ' << y << quadrant;
          }
        }
      });
  EXPECT_EQ(used, example.grid.rows);
}

TEST(EdgeAwareSums, LinksFallWithDistanceAndContrast) {
  const CellGrid grid(cv::Size(12, 8));
  const cv::Mat_<std::uint8_t> grey = (cv::Mat_<std::uint8_t>(2, 3) << 10, 10, 70, 10, 30, 70);
  const CellLinks links = linksOf(grid, grey);
  EXPECT_GT(links.right[0], 0.85F);
  EXPECT_LT(links.right[0], 1.0F);
  EXPECT_LT(links.right[1], 0.06F * links.right[0]);
  EXPECT_NEAR(links.below[1], links.right[3], 1e-6F);  // both differ by 20 grey levels
  EXPECT_EQ(links.right[2], 0.0F);
  EXPECT_EQ(links.below[3], 0.0F);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
