// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "rgbd_sfm_fusion/completion/surfaces.h"
#include "rgbd_sfm_fusion/fusion/evidence.h"
#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

using Source = Supports::Source;

constexpr int kSensor = static_cast<int>(Source::kSensor), kSfm = static_cast<int>(Source::kSfm);
constexpr float kRoughness = 1e-4F;    // of inverse depth: variance that keeps sure supports from ruling
constexpr float kLeastSpread = 1e-5F;  // squared spread of a plane's supports

/// Indices of the moments of a cell. A plane needs those before kForPlane; the others tell how sure it is.
enum Moment {
  kW,
  kWx,
  kWy,
  kWxx,
  kWxy,
  kWyy,
  kWr,
  kWxr,
  kWyr,
  kForPlane,
  kWrr = kForPlane,
  kOfSfmW,
  kOfSfmWv
};
static_assert(kOfSfmWv < kMomentLanes, "a lane for each");

/// What a row of planes is fitted with. `near` as in SurfaceDrawing, the others as in Supports.
struct RowToFit {
  const float* moments;
  int stride;  ///< from one moment to the next
  const std::uint8_t* near;
  const Source* source;
  const float *rho, *x, *y;
  float middle_y;
  int columns;
  bool is_last;  ///< what tells how sure a plane is is wanted, too
};

/// What the supports of a row weigh: by their σ, and by how much they are doubted.
RGBD_SFM_FUSION_MULTIVERSION
void weigh(const Source* source, const float* rho, const float* own, const float* doubt, int columns,
           float* __restrict weights) {
  for (int i = 0; i < columns; ++i) {
    const float weight = doubt[i] / (rho[i] * rho[i] * (own[i] + kRoughness));
    weights[i] = source[i] == Source::kNone ? 0.0F : weight;
  }
}

/// The moments of a row's supports; 0 without a support.
RGBD_SFM_FUSION_MULTIVERSION
void fillMoments(const float* weights, const Source* source, const float* rho, const float* xs,
                 const float* ys, const float* variances, int columns, float* __restrict moments) {
  for (int i = 0; i < columns; ++i) {
    const float w = weights[i], r = rho[i], x = xs[i], y = ys[i];
    const float of_sfm = source[i] >= Source::kSfm ? w : 0.0F;
    float* const to = moments + kMomentLanes * i;
    to[kW] = w, to[kWx] = w * x, to[kWy] = w * y, to[kWxx] = w * x * x;
    to[kWxy] = w * x * y, to[kWyy] = w * y * y, to[kWr] = w * r, to[kWxr] = w * x * r;
    to[kWyr] = w * y * r, to[kWrr] = w * r * r, to[kOfSfmW] = of_sfm, to[kOfSfmWv] = of_sfm * variances[i];
  }
}

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
    const float* m[kMomentLanes];  // the last ones mean nothing before the last plane
    float support[kLanes], x[kLanes], y[kLanes];
    int near[kLanes], source[kLanes];
    for (int k = 0; k < kMomentLanes; ++k) m[k] = row.moments + row.stride * k + first;
    load(row.near + first, count, near);
    load(row.source + first, count, source);
    load(row.rho + first, count, support);
    load(row.x + first, count, x);
    load(row.y + first, count, y);
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
      const bool is_fit = (near[l] != 0) & (m[kW][l] > 1e-20F) & (at_middle > 0.0F);
      is_plane[l] = is_fit ? 1 : 0;
      rho[l] = is_fit ? at_middle : 0.0F;
      slope_x[l] = is_fit ? gx : 0.0F;
      slope_y[l] = is_fit ? gy : 0.0F;
      misfit[l] = greater(0.0F, square) / (mr * mr);
      lever[l] = greater(0.0F, b * ux * ux - 2.0F * xy * ux * uy + a * uy * uy) / determinant;
      const float of_sfm = Evidence::kShare * m[kOfSfmWv][l] / m[kOfSfmW][l];
      variance[l] = m[kOfSfmW][l] > 0.0F ? of_sfm : 0.0F;
      const float dx = grid.middleX(first + l) - x[l], dy = row.middle_y - y[l];
      const float sure = is_fit ? support[l] + gx * dx + gy * dy : support[l];
      middle[l] = (source[l] == kSensor) | (source[l] == kSfm) ? sure : rho[l];
    }
    store(rho, count, rhos + first);
    store(slope_x, count, slopes_x + first);
    store(slope_y, count, slopes_y + first);
    store(middle, count, middles + first);
    if (!row.is_last) continue;
    for (int l = 0; l < count; ++l) {
      misfits[first + l] = is_plane[l] != 0 ? misfit[l] : misfits[first + l];
      levers[first + l] = lever[l];
      variances[first + l] = is_plane[l] != 0 ? variance[l] : variances[first + l];
    }
  }
}

}  // namespace

void SurfaceDrawing::fit(const CellGrid& grid, const CellLinks& links, const Supports& supports,
                         bool is_last) {
  const std::size_t count = grid.size();
  middle_.resize(count);
  levers_.resize(count);
  std::vector<float> weights(static_cast<std::size_t>(grid.columns));
  const auto fill_row = [&](int row, float* moments) {
    const std::size_t first = grid.index(row, 0);
    const Source* const source = supports.source.data() + first;
    const float* const rho = supports.rho.data() + first;
    weigh(source, rho, supports.own.data() + first, weights_.data() + first, grid.columns, weights.data());
    fillMoments(weights.data(), source, rho, supports.x.data() + first, supports.y.data() + first,
                supports.variance.data() + first, grid.columns, moments);
  };
  const auto fit_row = [&](int row, const float* moments) {
    const std::size_t first = grid.index(row, 0);
    fitPlanes(grid,
              {moments, static_cast<int>(LinkedSums::stride(grid)), near_.data() + first,
               supports.source.data() + first, supports.rho.data() + first, supports.x.data() + first,
               supports.y.data() + first, grid.middleY(row), grid.columns, is_last},
              surfaces_.rho.data() + first, surfaces_.slope_x.data() + first,
              surfaces_.slope_y.data() + first, surfaces_.misfit.data() + first, levers_.data() + first,
              surfaces_.variance.data() + first, middle_.data() + first);
  };
  sums_.overAll(grid, links, is_last ? kMomentLanes : kForPlane, fill_row, fit_row);
}

}  // namespace rgbd_sfm_fusion
