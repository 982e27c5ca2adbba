// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>

#include "rgbd_sfm_fusion/completion/surfaces.h"
#include "rgbd_sfm_fusion/fusion/evidence.h"
#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

using Source = Supports::Source;

constexpr float kRoughness = 1e-4F;    // of inverse depth: variance that keeps sure supports from ruling
constexpr float kLeastSpread = 1e-5F;  // squared spread of a plane's supports

/// Indices of the moments of a cell.
enum Moment { kW, kWx, kWy, kWxx, kWxy, kWyy, kWr, kWxr, kWyr, kWrr, kOfSfmW, kOfSfmWv };
static_assert(kOfSfmWv < kMomentLanes, "a lane for each");

/// Links between squares of 2 x 2 cells from the links between cells, for a row of squares.
/// @param first, second  links of the squares' two rows to the right; or of their two columns to below
/// @param next           from a link to the one after it, on the way from square to square
/// @param count          of the squares that have one after them
RGBD_SFM_FUSION_MULTIVERSION
void linkSquares(const float* first, const float* second, int next, int count, float* __restrict links) {
  // From middle to middle, half a step in each square, and one between them.
  for (int i = 0; i < count; ++i) {
    const int at = 2 * i;
    const float by_first = first[at + next] * std::sqrt(first[at] * first[at + 2 * next]);
    const float by_second = second[at + next] * std::sqrt(second[at] * second[at + 2 * next]);
    links[i] = 0.5F * (by_first + by_second);
  }
}

/// The planes of a row of squares, at their middles.
struct FittedRow {
  float *rho, *slope_x, *slope_y, *misfit, *variance;
};

/// A plane by weighted least squares for each square of a row. The prior of slopes is N(0, 2²) per unit,
/// relative to rho. Without it, a few supports in a line would leave one slope open.
/// @param x_first, y  of the middle of the row's first square
/// @param to          rho is 0 where no plane is fitted, as there is no support
RGBD_SFM_FUSION_MULTIVERSION
void fitPlanes(const float* moments, int count, float x_first, float y, const FittedRow& to) {
  for (int first = 0; first < count; first += kLanes) {
    const int length = std::min(kLanes, count - first);
    float m[kMomentLanes][kLanes];
    for (int l = 0; l < kLanes; ++l) {
      const float* const of = moments + kMomentLanes * (first + std::min(l, length - 1));
      for (int k = 0; k < kMomentLanes; ++k) m[k][l] = of[k];
    }
    float rho[kLanes], slope_x[kLanes], slope_y[kLanes], misfit[kLanes], variance[kLanes];
    for (int l = 0; l < kLanes; ++l) {
      const float w = 1.0F / m[kW][l], mx = m[kWx][l] * w, my = m[kWy][l] * w, mr = m[kWr][l] * w;
      const float xx = m[kWxx][l] * w - mx * mx, xy = m[kWxy][l] * w - mx * my, yy = m[kWyy][l] * w - my * my;
      const float xr = m[kWxr][l] * w - mx * mr, yr = m[kWyr][l] * w - my * mr, rr = m[kWrr][l] * w - mr * mr;
      const float prior = 0.25F / (m[kW][l] * mr * mr) + kLeastSpread;
      const float a = greater(0.0F, xx) + prior, b = greater(0.0F, yy) + prior;
      const float determinant = greater(prior * prior, a * b - xy * xy);
      const float gx = (b * xr - xy * yr) / determinant, gy = (a * yr - xy * xr) / determinant;
      const float square =
          rr - 2.0F * (gx * xr + gy * yr) + gx * gx * xx + 2.0F * gx * gy * xy + gy * gy * yy;
      const float x = x_first + 2.0F * CellGrid::kSpacing * static_cast<float>(first + l);
      const float at_middle = mr + gx * (x - mx) + gy * (y - my);
      const bool is_fit = m[kW][l] > 1e-20F;
      rho[l] = is_fit ? at_middle : 0.0F;
      slope_x[l] = is_fit ? gx : 0.0F;
      slope_y[l] = is_fit ? gy : 0.0F;
      misfit[l] = is_fit ? greater(0.0F, square) / (mr * mr) : 0.0F;
      const float of_sfm = Evidence::kShare * m[kOfSfmWv][l] / m[kOfSfmW][l];
      variance[l] = m[kOfSfmW][l] > 0.0F ? of_sfm : 0.0F;
    }
    std::copy_n(rho, length, to.rho + first);
    std::copy_n(slope_x, length, to.slope_x + first);
    std::copy_n(slope_y, length, to.slope_y + first);
    std::copy_n(misfit, length, to.misfit + first);
    std::copy_n(variance, length, to.variance + first);
  }
}

/// A row of cells to which the planes of their squares are given. `near` as in SurfaceDrawing, the others as
/// in Supports.
struct RowOfCells {
  const std::uint8_t* near;
  const Source* source;
  const float *rho, *x, *y;
  float x_first, middle_y;  ///< of the middle of the first cell
  float offset_y;           ///< from the squares' middles
  int columns;
};

/// @param fitted   with each square's values twice: once for each of its columns
/// @param to       planes at the middles of cells; 0 in cells that are not near
/// @param middles  [out] the published support, or else the plane, at the cells' middles
RGBD_SFM_FUSION_MULTIVERSION
void givePlanes(const FittedRow& fitted, const RowOfCells& row, const FittedRow& to,
                float* __restrict middles) {
  float* __restrict rhos = to.rho, * __restrict slopes_x = to.slope_x, * __restrict slopes_y = to.slope_y, * __restrict misfits = to.misfit, * __restrict variances = to.variance;
  for (int i = 0; i < row.columns; ++i) {
    const float offset_x = CellGrid::kSpacing * (static_cast<float>(i & 1) - 0.5F);
    const float gx = fitted.slope_x[i], gy = fitted.slope_y[i], fitted_rho = fitted.rho[i];
    const float at_middle = fitted_rho + gx * offset_x + gy * row.offset_y;
    const bool is_fit = (row.near[i] != 0) & (fitted_rho != 0.0F) & (at_middle > 0.0F);
    const float rho = is_fit ? at_middle : 0.0F, slope_x = is_fit ? gx : 0.0F, slope_y = is_fit ? gy : 0.0F;
    const float x = row.x_first + CellGrid::kSpacing * static_cast<float>(i);
    const float sure = row.rho[i] + slope_x * (x - row.x[i]) + slope_y * (row.middle_y - row.y[i]);
    const bool is_sure = (row.source[i] == Source::kSensor) | (row.source[i] == Source::kSfm);
    rhos[i] = rho;
    slopes_x[i] = slope_x;
    slopes_y[i] = slope_y;
    misfits[i] = fitted.misfit[i];
    variances[i] = fitted.variance[i];
    middles[i] = is_sure ? sure : rho;
  }
}

RGBD_SFM_FUSION_MULTIVERSION
void repeatEach(const float* values, int count, float* __restrict twice) {
  for (int i = 0; i < count; ++i) twice[2 * i] = twice[2 * i + 1] = values[i];
}

}  // namespace

void SurfaceDrawing::linkAll(const CellGrid& grid, const CellGrid& squares, const CellLinks& links) {
  square_links_.right.assign(squares.size(), 0.0F);
  square_links_.below.assign(squares.size(), 0.0F);
  for (int row = 0; row < squares.rows; ++row) {
    const std::size_t from = grid.index(2 * row, 0), to = squares.index(row, 0);
    const float *const right = links.right.data() + from, *const below = links.below.data() + from;
    linkSquares(right, right + grid.columns, 1, squares.columns - 1, square_links_.right.data() + to);
    if (row + 1 < squares.rows)
      linkSquares(below, below + 1, grid.columns, squares.columns, square_links_.below.data() + to);
  }
}

void SurfaceDrawing::fit(const CellGrid& grid, const CellLinks& links, const Supports& supports) {
  const CellGrid squares = grid.ofSquares();
  linkAll(grid, squares, links);
  const std::size_t lanes = kMomentLanes, row_length = lanes * squares.index(1, 0);
  moments_.resize(squares.size() * lanes);
  work_.resize(squares.size() * lanes);
  middle_.resize(grid.size());
  const auto fill_row = [&](int row) {
    float* const moments = moments_.data() + row_length * static_cast<std::size_t>(row);
    std::fill_n(moments, row_length, 0.0F);
    for (int y = 2 * row; y < 2 * row + 2; ++y) {
      for (int column = 0; column < grid.columns; ++column) {
        const std::size_t cell = grid.index(y, column);
        if (supports.source[cell] == Source::kNone) continue;
        const float r = supports.rho[cell], px = supports.x[cell], py = supports.y[cell];
        const float w = weights_[cell] / (r * r * (supports.own[cell] + kRoughness));
        const float of_sfm = supports.isOfSfm(cell) ? w : 0.0F, wx = w * px, wy = w * py, wr = w * r;
        const std::array<float, kMomentLanes> of_cell = {
            w,  wx,     wy,     wx * px, wx * py, wy * py,
            wr, wx * r, wy * r, wr * r,  of_sfm,  of_sfm * supports.variance[cell]};
        float* const to = moments + kMomentLanes * (column / 2);
        for (std::size_t k = 0; k < lanes; ++k) to[k] += of_cell[k];
      }
    }
  };
  const auto count = static_cast<std::size_t>(squares.columns);
  row_buffer_.resize(15 * count);
  const auto row_at = [&](std::size_t from, std::size_t length) -> FittedRow {
    float* const at = row_buffer_.data() + from;
    return {at, at + length, at + 2 * length, at + 3 * length, at + 4 * length};
  };
  const FittedRow fitted = row_at(0, count), twice = row_at(5 * count, 2 * count);
  const auto fit_row = [&](int row) {
    fitPlanes(moments_.data() + row_length * static_cast<std::size_t>(row), squares.columns,
              grid.middleX(0) + 0.5F * CellGrid::kSpacing, grid.middleY(2 * row) + 0.5F * CellGrid::kSpacing,
              fitted);
    repeatEach(fitted.rho, 5 * squares.columns, twice.rho);
    for (int y = 2 * row; y < 2 * row + 2; ++y) {
      const std::size_t first = grid.index(y, 0);
      const RowOfCells cells{near_.data() + first,
                             supports.source.data() + first,
                             supports.rho.data() + first,
                             supports.x.data() + first,
                             supports.y.data() + first,
                             grid.middleX(0),
                             grid.middleY(y),
                             CellGrid::kSpacing * (static_cast<float>(y % 2) - 0.5F),
                             grid.columns};
      givePlanes(
          twice, cells,
          {surfaces_.rho.data() + first, surfaces_.slope_x.data() + first, surfaces_.slope_y.data() + first,
           surfaces_.misfit.data() + first, surfaces_.variance.data() + first},
          middle_.data() + first);
    }
  };
  sumAlongLinks(squares, square_links_, moments_, work_, fill_row, fit_row);
}

}  // namespace rgbd_sfm_fusion
