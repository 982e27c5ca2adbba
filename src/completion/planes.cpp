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

/// What a row of planes is fitted with. `near` as in SurfaceDrawing, the others as in Supports.
struct RowToFit {
  const float* moments;
  const std::uint8_t* near;
  const Source* source;
  const float *rho, *x, *y;
  float middle_y;
  int columns;
};

/// A plane by weighted least squares for each cell of a row. The prior of slopes is N(0, 2²) per unit,
/// relative to rho. Without it, a few supports in a line would leave one slope open.
RGBD_SFM_FUSION_MULTIVERSION
void fitPlanes(const CellGrid& grid, const RowToFit& row, float* __restrict rhos, float* __restrict slopes_x,
               float* __restrict slopes_y, float* __restrict misfits, float* __restrict levers,
               float* __restrict variances, float* __restrict middles) {
  for (int first = 0; first < row.columns; first += kLanes) {
    const int count = std::min(kLanes, row.columns - first);
    if (hasNone(row.near + first, count)) {
      for (int column = first; column < first + count; ++column) {
        const bool is_sure = (row.source[column] == Source::kSensor) | (row.source[column] == Source::kSfm);
        rhos[column] = slopes_x[column] = slopes_y[column] = 0.0F;
        middles[column] = is_sure ? row.rho[column] : 0.0F;
      }
      continue;
    }
    float m[kMomentLanes][kLanes], support[kLanes], dx[kLanes], dy[kLanes];
    int is_near[kLanes], is_sure[kLanes];
    for (int l = 0; l < kLanes; ++l) {
      const int column = first + std::min(l, count - 1);
      for (int k = 0; k < kMomentLanes; ++k) m[k][l] = row.moments[kMomentLanes * column + k];
      is_near[l] = row.near[column];
      is_sure[l] = (row.source[column] == Source::kSensor) | (row.source[column] == Source::kSfm);
      support[l] = row.rho[column];
      dx[l] = grid.middleX(column) - row.x[column];
      dy[l] = row.middle_y - row.y[column];
    }
    float rho[kLanes], slope_x[kLanes], slope_y[kLanes], misfit[kLanes], lever[kLanes], variance[kLanes],
        middle[kLanes];
    int is_plane[kLanes];
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
      const float ux = grid.middleX(first + l) - mx, uy = row.middle_y - my;
      const float at_middle = mr + gx * ux + gy * uy;
      const bool is_fit = (is_near[l] != 0) & (m[kW][l] > 1e-20F) & (at_middle > 0.0F);
      is_plane[l] = is_fit ? 1 : 0;
      rho[l] = is_fit ? at_middle : 0.0F;
      slope_x[l] = is_fit ? gx : 0.0F;
      slope_y[l] = is_fit ? gy : 0.0F;
      misfit[l] = greater(0.0F, square) / (mr * mr);
      lever[l] = greater(0.0F, b * ux * ux - 2.0F * xy * ux * uy + a * uy * uy) / determinant;
      const float of_sfm = Evidence::kShare * m[kOfSfmWv][l] / m[kOfSfmW][l];
      variance[l] = m[kOfSfmW][l] > 0.0F ? of_sfm : 0.0F;
      const float sure = is_fit ? support[l] + gx * dx[l] + gy * dy[l] : support[l];
      middle[l] = is_sure[l] != 0 ? sure : rho[l];
    }
    for (int l = 0; l < count; ++l) {
      rhos[first + l] = rho[l];
      slopes_x[first + l] = slope_x[l];
      slopes_y[first + l] = slope_y[l];
      middles[first + l] = middle[l];
      misfits[first + l] = is_plane[l] != 0 ? misfit[l] : misfits[first + l];
      levers[first + l] = lever[l];
      variances[first + l] = is_plane[l] != 0 ? variance[l] : variances[first + l];
    }
  }
}

}  // namespace

void SurfaceDrawing::fit(const CellGrid& grid, const CellLinks& links, const Supports& supports) {
  const std::size_t count = grid.size(), lanes = kMomentLanes;
  moments_.resize(count * lanes);
  work_.resize(count * lanes);
  middle_.resize(count);
  levers_.resize(count);
  const auto fill_row = [&](int row) {
    for (std::size_t cell = grid.index(row, 0); cell < grid.index(row + 1, 0); ++cell) {
      float* to = moments_.data() + lanes * cell;
      if (supports.source[cell] == Source::kNone) {
        std::fill_n(to, lanes, 0.0F);
        continue;
      }
      const float r = supports.rho[cell], x = supports.x[cell], y = supports.y[cell];
      const float w = weights_[cell] / (r * r * (supports.own[cell] + kRoughness));
      const float of_sfm = supports.isOfSfm(cell) ? w : 0.0F;
      const std::array<float, kMomentLanes> moments = {
          w,     w * x,     w * y,     w * x * x, w * x * y, w * y * y,
          w * r, w * x * r, w * y * r, w * r * r, of_sfm,    of_sfm * supports.variance[cell]};
      std::copy(moments.begin(), moments.end(), to);
    }
  };
  const auto fit_row = [&](int row) {
    const std::size_t first = grid.index(row, 0);
    fitPlanes(grid,
              {moments_.data() + lanes * first, near_.data() + first, supports.source.data() + first,
               supports.rho.data() + first, supports.x.data() + first, supports.y.data() + first,
               grid.middleY(row), grid.columns},
              surfaces_.rho.data() + first, surfaces_.slope_x.data() + first,
              surfaces_.slope_y.data() + first, surfaces_.misfit.data() + first, levers_.data() + first,
              surfaces_.variance.data() + first, middle_.data() + first);
  };
  sumAlongLinks(grid, links, moments_, work_, fill_row, fit_row);
}

}  // namespace rgbd_sfm_fusion
