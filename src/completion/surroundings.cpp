// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "rgbd_sfm_fusion/completion/surfaces.h"
#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr float kStep = 0.1F;     // [1] of inverse depth, from a plane to a neighbouring cell: an occlusion
constexpr int kSurroundings = 8;  // [cells] on each side: they tell whether the surface may have ended here

/// A farther surface is looked for along eight rays, at these distances.
constexpr std::array<int, 6> kDistances = {1, 2, 3, 4, 6, kSurroundings};  // [cells]

/// Probability that a cell already belongs to a farther surface that is seen beside it. In kReach cells, it
/// falls to a third. scripts/fit_completion prints both. They are rather too large, as the learned factor
/// reduces them.
constexpr float kBeside = 0.6F, kReach = 4.0F;
/// Surfaces end at edges of the image. So this probability, and that of what is not known, are multiplied by
/// kWithoutEdge + contrast / kContrast, and by kAtMost at most.
constexpr float kWithoutEdge = 0.5F, kAtMost = 2.5F;
constexpr float kContrast = 40.0F;    // [grey levels] in the 3 x 3 cells around
constexpr float kUnseenStep = 0.17F;  // [1] to a farther surface that is not seen

float square(float value) {
  return value * value;
}

/// Where a farther surface is looked for, from a cell.
struct Look {
  int dx, dy;  ///< [cells]
  float root;  ///< of the probability that the cell is of a surface that is seen there
};

/// The cell itself, and the distances along the rays.
const std::vector<Look>& looks() {
  static const std::vector<Look> all = [] {
    std::vector<Look> looks = {{0, 0, std::sqrt(kBeside)}};
    for (const int distance : kDistances) {
      for (const int dy : {-distance, 0, distance}) {
        for (const int dx : {-distance, 0, distance}) {
          const float length = std::hypot(static_cast<float>(dx), static_cast<float>(dy));
          if (dx != 0 || dy != 0) looks.push_back({dx, dy, std::sqrt(kBeside * std::exp(-length / kReach))});
        }
      }
    }
    return looks;
  }();
  return all;
}

/// The planes of a row of cells.
struct Planes {
  const float *rho, *slope_x, *slope_y;
};

/// Marks cells whose plane makes a step to the depth in the cell that is (dx, dy) away. Unknown depth is 0.
RGBD_SFM_FUSION_MULTIVERSION
void markSteps(const Planes& planes, const float* depth, float dx, float dy, int columns,
               std::uint8_t* __restrict steps) {
  for (int x = 0; x < columns; ++x) {
    const float ratio = depth[x] * (planes.rho[x] + planes.slope_x[x] * dx + planes.slope_y[x] * dy);
    const bool is_step = (depth[x] > 0.0F) & ((ratio > 1.0F + kStep) | (ratio * (1.0F + kStep) < 1.0F));
    steps[x] = static_cast<std::uint8_t>(steps[x] | (is_step ? 1 : 0));
  }
}

/// By how much the depth in the cell that is (dx, dy) away is farther than the plane. Raises `farthest` to
/// it, and `weighted` to it times the root of its probability. Selections from constants would keep the loop
/// scalar.
RGBD_SFM_FUSION_MULTIVERSION
void lookFor(const Planes& planes, const float* depth, float dx, float dy, float root, int columns,
             float* __restrict farthest, float* __restrict weighted) {
  for (int x = 0; x < columns; ++x) {
    const float plane = planes.rho[x] + planes.slope_x[x] * dx + planes.slope_y[x] * dy;
    const float step = depth[x] * plane - 1.0F;
    farthest[x] = step > farthest[x] ? step : farthest[x];
    weighted[x] = step * root > weighted[x] ? step * root : weighted[x];
  }
}

/// The cells of a row from the first to the last one that is drawn.
struct Span {
  int first = 0, length = 0;
};

Span drawnSpan(const Surfaces& surfaces, const CellGrid& grid, int row) {
  const auto begin = surfaces.drawn.begin() + static_cast<std::ptrdiff_t>(grid.index(row, 0));
  const auto is_drawn = [](std::uint8_t drawn) { return drawn != Surfaces::kNot; };
  const auto first = std::find_if(begin, begin + grid.columns, is_drawn);
  if (first == begin + grid.columns) return {};
  const auto from_right = std::make_reverse_iterator(begin + grid.columns);
  const auto last = std::find_if(from_right, std::make_reverse_iterator(first), is_drawn);
  return {static_cast<int>(first - begin), static_cast<int>(last.base() - first)};
}

/// [grey levels] Range of the brightness of the 3 x 3 cells around each.
cv::Mat_<std::uint8_t> contrastOf(const cv::Mat_<std::uint8_t>& grey) {
  const cv::Mat around = cv::Mat::ones(3, 3, CV_8U);
  cv::Mat_<std::uint8_t> brightest, darkest;
  cv::dilate(grey, brightest, around);
  cv::erode(grey, darkest, around);
  cv::subtract(brightest, darkest, brightest);
  return brightest;
}

Planes planesOf(const Surfaces& surfaces, const CellGrid& grid, int row, int column) {
  const std::size_t first = grid.index(row, column);
  return {surfaces.rho.data() + first, surfaces.slope_x.data() + first, surfaces.slope_y.data() + first};
}

/// @param depth  with a border of kSurroundings
const float* depthAt(const cv::Mat_<float>& depth, int row, int column) {
  return depth[row + kSurroundings] + column + kSurroundings;
}

}  // namespace

void SurfaceDrawing::keepOffSteps(const CellGrid& grid) {
  const cv::Size size(grid.columns, grid.rows);
  cv::Mat_<float> depth(size);
  unknown_.create(size);
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const std::size_t cell = grid.index(row, column);
      depth(row, column) = known_[cell] != 0 && middle_[cell] > 0.0F ? 1.0F / middle_[cell] : 0.0F;
      unknown_(row, column) = known_[cell] == 0 && near_[cell] != 0 ? 1 : 0;
    }
  }
  cv::copyMakeBorder(depth, depth_, kSurroundings, kSurroundings, kSurroundings, kSurroundings,
                     cv::BORDER_CONSTANT, 0.0);
  cv::Mat_<std::uint8_t> beside_unknown, steps(size, std::uint8_t{0});
  cv::dilate(unknown_, beside_unknown, cv::Mat::ones(3, 3, CV_8U), {-1, -1}, 1, cv::BORDER_CONSTANT, 1.0);
  for (int row = 0; row < grid.rows; ++row) {
    const Span span = drawnSpan(surfaces_, grid, row);
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx)
        markSteps(planesOf(surfaces_, grid, row, span.first), depthAt(depth_, row + dy, span.first + dx),
                  CellGrid::kSpacing * static_cast<float>(dx), CellGrid::kSpacing * static_cast<float>(dy),
                  span.length, steps[row] + span.first);
    }
    for (int column = span.first; column < span.first + span.length; ++column) {
      std::uint8_t& drawn = surfaces_.drawn[grid.index(row, column)];
      if (steps(row, column) != 0 || (drawn == Surfaces::kInGap && beside_unknown(row, column) != 0))
        drawn = Surfaces::kNot;
    }
  }
}

void SurfaceDrawing::lookAround(const CellGrid& grid, const cv::Mat_<std::uint8_t>& grey) {
  const cv::Mat_<std::uint8_t> contrast = contrastOf(grey);
  cv::Mat_<float> unknown;
  const cv::Size around(2 * kSurroundings + 1, 2 * kSurroundings + 1);
  cv::boxFilter(unknown_, unknown, CV_32F, around, {-1, -1}, true, cv::BORDER_CONSTANT);
  const auto columns = static_cast<std::size_t>(grid.columns);
  std::vector<float> farthest(columns), weighted(columns);
  for (int row = 0; row < grid.rows; ++row) {
    const Span span = drawnSpan(surfaces_, grid, row);
    if (span.length == 0) continue;
    std::fill(farthest.begin(), farthest.end(), kUnseenStep);
    std::fill(weighted.begin(), weighted.end(), 0.0F);
    for (const Look& look : looks()) {
      if (row + look.dy < 0 || row + look.dy >= grid.rows) continue;
      lookFor(
          planesOf(surfaces_, grid, row, span.first), depthAt(depth_, row + look.dy, span.first + look.dx),
          CellGrid::kSpacing * static_cast<float>(look.dx), CellGrid::kSpacing * static_cast<float>(look.dy),
          look.root, span.length, farthest.data(), weighted.data());
    }
    for (int column = span.first; column < span.first + span.length; ++column) {
      const std::size_t cell = grid.index(row, column), x = static_cast<std::size_t>(column - span.first);
      // A shadow's width shows that the surface goes on.
      const float unseen = surfaces_.drawn[cell] == Surfaces::kInShadow ? 0.0F : unknown(row, column);
      const float edge =
          std::min(kWithoutEdge + static_cast<float>(contrast(row, column)) / kContrast, kAtMost);
      const float step = square(std::min(farthest[x], 1.0F));
      surfaces_.other[cell] = std::min(edge * std::max(square(weighted[x]), kBeside * unseen * step), step);
    }
  }
}

}  // namespace rgbd_sfm_fusion
