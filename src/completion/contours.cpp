// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "rgbd_sfm_fusion/completion/surfaces.h"
#include "rgbd_sfm_fusion/mapping/epipolar_segments.h"
#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

/// [cells] SfM's depth straddles a contour by the pattern that stereo compares. Surfaces grow by as much.
constexpr int kStripe = (2 * kPatternRadius + 1 + CellGrid::kSize - 1) / CellGrid::kSize;

/// Marks cells that are one surface with their neighbour: the planes meet half-way.
/// @param next  from a cell to its neighbour
RGBD_SFM_FUSION_MULTIVERSION
void join(const float* ends, const float* slopes, int next, int count, std::uint8_t* __restrict joined) {
  for (int i = 0; i < count; ++i) {
    const float here = ends[i] + 0.5F * CellGrid::kSpacing * slopes[i],
                there = ends[i + next] - 0.5F * CellGrid::kSpacing * slopes[i + next];
    const bool exist = (ends[i] > 0.0F) & (ends[i + next] > 0.0F);
    joined[i] = exist & (std::abs(here - there) < kSurfaceStep * there) ? 1 : 0;
  }
}

/// Marks drawn cells that are one surface with one of two neighbours only.
/// @param joined  to the next cell of the row, and of the column, as the cells at -1 and -`stride` are to
///                this one
RGBD_SFM_FUSION_MULTIVERSION
void markEnds(const std::uint8_t* drawn, const std::uint8_t* joined_right, const std::uint8_t* joined_below,
              int stride, int count, std::uint8_t* __restrict marks) {
  for (int i = 0; i < count; ++i) {
    const int ends = (joined_right[i - 1] ^ joined_right[i]) | (joined_below[i - stride] ^ joined_below[i]);
    marks[i] = (drawn[i] != Surfaces::kNot) & (ends != 0) ? 1 : 0;
  }
}

/// Marks cells without a surface that are beside one between SfM's depths, without an edge of the image in
/// between.
RGBD_SFM_FUSION_MULTIVERSION
void markGrowing(const std::uint8_t* wanted, const float* ends, const std::uint8_t* drawn,
                 const std::uint8_t* grey, int stride, int count, std::uint8_t* __restrict marks) {
  for (int i = 0; i < count; ++i) {
    const auto from = [&](int beside) {
      return (drawn[i + beside] == Surfaces::kBetweenSfm) & (std::abs(grey[i + beside] - grey[i]) < kEdge);
    };
    const bool has_source = from(1) | from(-1) | from(stride) | from(-stride);
    marks[i] = (wanted[i] != 0) & (ends[i] == 0.0F) & has_source ? 1 : 0;
  }
}

}  // namespace

/// Calls visit(row, column) for drawn cells that may have two sides: those at which a surface ends, and all
/// at the image's border.
template <typename Visitor>
void SurfaceDrawing::forEachEnd(const CellGrid& grid, const Visitor& visit) const {
  std::vector<std::uint8_t> marks(static_cast<std::size_t>(grid.columns));
  for (int row = 0; row < grid.rows; ++row) {
    const std::size_t first = grid.index(row, 0);
    std::copy_n(surfaces_.drawn.data() + first, marks.size(), marks.data());
    if (row > 0 && row + 1 < grid.rows)
      markEnds(surfaces_.drawn.data() + first + 1, joined_right_.data() + first + 1,
               joined_below_.data() + first + 1, grid.columns, grid.columns - 2, marks.data() + 1);
    for (int column = 0; column < grid.columns; ++column) {
      if (marks[static_cast<std::size_t>(column)] != 0) visit(row, column);
    }
  }
}

void SurfaceDrawing::keepToContours(const CellGrid& grid, const cv::Mat_<std::uint8_t>& grey,
                                    const Supports& supports, const std::vector<std::uint8_t>& wanted) {
  ends_.resize(grid.size());
  for (std::size_t cell = 0; cell < ends_.size(); ++cell) {
    const bool is_drawn = surfaces_.drawn[cell] != Surfaces::kNot;
    ends_[cell] = is_drawn ? surfaces_.rho[cell] : supports.isPublished(cell) ? middle_[cell] : 0.0F;
  }
  for (int i = 0; i < kStripe; ++i) {
    joinCells(grid);
    giveUpOtherSides(grid, grey);
  }
  for (int i = 0; i < kStripe; ++i) grow(grid, grey, wanted);
  joinCells(grid);
  surfaces_.sides.assign(grid.size(), {});
  forEachEnd(grid, [&](int row, int column) {
    surfaces_.sides[grid.index(row, column)] = sidesOf(grid, grey, row, column);
  });
}

void SurfaceDrawing::joinCells(const CellGrid& grid) {
  joined_right_.assign(grid.size(), 0);
  joined_below_.assign(grid.size(), 0);
  for (int row = 0; row < grid.rows; ++row) {
    const std::size_t first = grid.index(row, 0);
    const float* const ends = ends_.data() + first;
    join(ends, surfaces_.slope_x.data() + first, 1, grid.columns - 1, joined_right_.data() + first);
    if (row + 1 < grid.rows)
      join(ends, surfaces_.slope_y.data() + first, grid.columns, grid.columns, joined_below_.data() + first);
  }
}

Sides SurfaceDrawing::sidesOf(const CellGrid& grid, const cv::Mat_<std::uint8_t>& grey, int row,
                              int column) const {
  Sides sides;
  const std::size_t cell = grid.index(row, column), above = cell - static_cast<std::size_t>(grid.columns);
  const auto divide = [&](int axis, bool joins_before, bool joins_after, std::uint8_t before,
                          std::uint8_t after) {
    if (joins_before == joins_after || std::abs(before - after) < kEdge) return;
    sides.own[axis] = joins_before ? before : after;
    sides.other[axis] = joins_before ? after : before;
  };
  if (column > 0 && column + 1 < grid.columns)
    divide(0, joined_right_[cell - 1] != 0, joined_right_[cell] != 0, grey(row, column - 1),
           grey(row, column + 1));
  if (row > 0 && row + 1 < grid.rows)
    divide(1, joined_below_[above] != 0, joined_below_[cell] != 0, grey(row - 1, column),
           grey(row + 1, column));
  return sides;
}

void SurfaceDrawing::giveUpOtherSides(const CellGrid& grid, const cv::Mat_<std::uint8_t>& grey) {
  forEachEnd(grid, [&](int row, int column) {
    const std::size_t cell = grid.index(row, column);
    const Sides sides = sidesOf(grid, grey, row, column);
    const int here = grey(row, column);
    for (const int axis : {0, 1}) {
      if (2 * std::abs(here - sides.other[axis]) >= std::abs(here - sides.own[axis])) continue;
      surfaces_.drawn[cell] = Surfaces::kNot;
      ends_[cell] = 0.0F;
    }
  });
}

void SurfaceDrawing::grow(const CellGrid& grid, const cv::Mat_<std::uint8_t>& grey,
                          const std::vector<std::uint8_t>& wanted) {
  std::vector<std::pair<std::size_t, std::size_t>> grown;
  std::vector<std::uint8_t> marks(static_cast<std::size_t>(grid.columns));
  for (int row = 1; row + 1 < grid.rows; ++row) {  // nothing grows at the image's border
    const std::size_t first = grid.index(row, 1);
    markGrowing(wanted.data() + first, ends_.data() + first, surfaces_.drawn.data() + first,
                grey.data + first, grid.columns, grid.columns - 2, marks.data() + 1);
    for (int column = 1; column + 1 < grid.columns; ++column) {
      if (marks[static_cast<std::size_t>(column)] != 0) growInto(grid, grey, row, column, &grown);
    }
  }
  for (const auto& [cell, from] : grown) {
    const int row = static_cast<int>(cell) / grid.columns, column = static_cast<int>(cell) % grid.columns;
    surfaces_.rho[cell] = ends_[cell] = planeAt(grid, from, row, column);
    for (const auto values :
         {&Surfaces::slope_x, &Surfaces::slope_y, &Surfaces::misfit, &Surfaces::variance, &Surfaces::other})
      (surfaces_.*values)[cell] = (surfaces_.*values)[from];
    surfaces_.drawn[cell] = Surfaces::kBetweenSfm;
  }
}

void SurfaceDrawing::growInto(const CellGrid& grid, const cv::Mat_<std::uint8_t>& grey, int row, int column,
                              std::vector<std::pair<std::size_t, std::size_t>>* grown) const {
  const std::size_t cell = grid.index(row, column), columns = static_cast<std::size_t>(grid.columns);
  std::size_t from = cell;
  int least = kEdge;
  for (const std::size_t beside : {cell + 1, cell - 1, cell + columns, cell - columns}) {
    const int difference = std::abs(grey.data[beside] - grey.data[cell]);
    if (surfaces_.drawn[beside] != Surfaces::kBetweenSfm || difference >= least) continue;
    from = beside;
    least = difference;
  }
  if (from == cell || planeAt(grid, from, row, column) <= 0.0F) return;
  for (int y = std::max(row - kStripe, 0); y <= std::min(row + kStripe, grid.rows - 1); ++y) {
    for (int x = std::max(column - kStripe, 0); x <= std::min(column + kStripe, grid.columns - 1); ++x) {
      const float there = ends_[grid.index(y, x)];
      if (there > 0.0F && std::abs(planeAt(grid, from, y, x) - there) >= kSurfaceStep * there) return;
    }
  }
  grown->emplace_back(cell, from);
}

float SurfaceDrawing::planeAt(const CellGrid& grid, std::size_t cell, int row, int column) const {
  const int from_row = static_cast<int>(cell) / grid.columns,
            from_column = static_cast<int>(cell) % grid.columns;
  return surfaces_.rho[cell] +
         CellGrid::kSpacing * (surfaces_.slope_x[cell] * static_cast<float>(column - from_column) +
                               surfaces_.slope_y[cell] * static_cast<float>(row - from_row));
}

}  // namespace rgbd_sfm_fusion
