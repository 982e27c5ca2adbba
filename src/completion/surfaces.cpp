// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/completion/surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "rgbd_sfm_fusion/fusion/evidence.h"
#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

using Source = Supports::Source;

constexpr float kStepScale = 0.04F;  // of inverse depth: such a step leaves a quarter of a support or link
constexpr float kLargestMisfit = 0.03F;    // of inverse depth, besides the supports' σ: more is no plane
constexpr float kStep = 0.1F;              // of inverse depth, from a plane to the mean of a quadrant
constexpr float kLeastOfQuadrant = 0.03F;  // supports, weighted by their links
// Limits for a gap without SfM: it is narrow, and no strong edge of the image separates it from the sensor's
// depth on any side.
constexpr float kLeastOfRim = 0.2F;  // supports of each quadrant, weighted by their links
constexpr int kWidestGap = 12;       // [cells]
constexpr float kTrace = 1e-6F;      // supports: fewer are as good as none
constexpr int kFewestQuadrants = 3;
constexpr float kSensorAtFirst = 1e-3F;  // weight of the sensor's supports before any surface is known
// Rounds of doubt. Of the depth that was removed from freiburg1_xyz and every third frame of it beyond 1.5 m,
// cafe beyond 2 and 3 m and corridor beyond 3.5 m, the third round completes .7 to 1.1 % more, a fourth
// .1 to .7 %.
constexpr int kRounds = 3;
constexpr int kMargin = 3;  // [cells] around wanted cells in which steps are looked for

float square(float value) {
  return value * value;
}

/// A weight that is 1 at 0 and 1/4 at 1, and falls on.
float doubtful(float value) {
  return square(1.0F / (1.0F + square(value)));
}

/// Indices of the values of a cell.
enum Value { kPixels, kX, kY, kRho, kOfSfm, kVariance };
static_assert(kVariance < kQuadrantLanes, "a lane for each");

/// 1 for cells without a support.
cv::Mat_<std::uint8_t> cellsWithout(const CellGrid& grid, const Supports& supports) {
  cv::Mat_<std::uint8_t> none(grid.rows, grid.columns);
  for (int row = 0; row < grid.rows; ++row) {
    for (int x = 0; x < grid.columns; ++x)
      none(row, x) = supports.source[grid.index(row, x)] == Source::kNone ? 1 : 0;
  }
  return none;
}

/// 1 for cells that lie in an empty square wider than the widest gap.
cv::Mat_<std::uint8_t> wideHoles(const cv::Mat_<std::uint8_t>& none) {
  const cv::Mat larger = cv::Mat::ones(kWidestGap + 1, kWidestGap + 1, CV_8U);
  cv::Mat_<std::uint8_t> result;
  cv::morphologyEx(none, result, cv::MORPH_OPEN, larger);
  return result;
}

/// Doubts the published supports of a row that are off their planes.
/// @param middles, own, rhos  as SurfaceDrawing, Supports and Surfaces have them
RGBD_SFM_FUSION_MULTIVERSION
void doubtSupports(const std::uint8_t* near, const Source* source, const float* middles, const float* own,
                   const float* rhos, int columns, float* __restrict weights) {
  for (int i = 0; i < columns; ++i) {
    const bool is_published = (source[i] == Source::kSensor) | (source[i] == Source::kSfm);
    const float weight =
        doubtful((middles[i] - rhos[i]) / (rhos[i] * std::sqrt(square(kStepScale) + own[i])));
    weights[i] = (near[i] != 0) & is_published & (rhos[i] > 0.0F) ? weight : 1.0F;
  }
}

/// Cuts links between cells whose planes make a step.
/// @param next  from a cell to the cell that it is linked to
RGBD_SFM_FUSION_MULTIVERSION
void cutLinks(const std::uint8_t* near, const float* middles, const float* slopes, int next, int count,
              float* __restrict links) {
  for (int i = 0; i < count; ++i) {
    const float here = middles[i] + 0.5F * CellGrid::kSpacing * slopes[i],
                there = middles[i + next] - 0.5F * CellGrid::kSpacing * slopes[i + next];
    const float farther = lesser(there, here);
    const float kept = farther > 0.0F ? doubtful((here - there) / (kStepScale * farther)) : 1.0F;
    links[i] = (near[i] != 0) & (near[i + next] != 0) ? links[i] * kept : links[i];
  }
}

/// What a row of planes is judged by: what the supports in each cell's quadrants say.
struct RowToJudge {
  std::array<const float*, 4> quadrants;
  int stride;  ///< from one value of a quadrant to the next
  const float *rho, *slope_x, *slope_y, *lever;
  const Source* source;
  const std::uint8_t *near, *is_wide;
  float middle_y;
  int columns;
};

/// @param misfits  [in] of the supports; [out] of the surface at the cell
/// @param known, drawn, variances  [out] as in SurfaceDrawing and Surfaces
RGBD_SFM_FUSION_MULTIVERSION
void judgePlanes(const CellGrid& grid, const RowToJudge& row, std::uint8_t* __restrict known,
                 std::uint8_t* __restrict drawn, float* __restrict misfits, float* __restrict variances) {
  for (int first = 0; first < row.columns; first += kLanes) {
    const int count = std::min(kLanes, row.columns - first);
    if (hasNone(row.near + first, count)) {  // such cells have no plane
      std::fill_n(known + first, count, std::uint8_t{0});
      std::fill_n(drawn + first, count, static_cast<std::uint8_t>(Surfaces::kNot));
      continue;
    }
    int supported[kLanes] = {}, by_sfm[kLanes] = {};  // numbers of quadrants
    float least[kLanes];                              // supports of a quadrant, weighted by their links
    float all[kLanes] = {};                           // supports, weighted by their links
    float variance[kLanes] = {};                      // [1] sum of the supports' variances, weighted likewise
    float offset[kLanes] = {};  // [1/m] largest distance of a quadrant's mean from the plane
    float rho[kLanes], slope_x[kLanes], slope_y[kLanes];
    for (int l = 0; l < kLanes; ++l) least[l] = std::numeric_limits<float>::max();
    load(row.rho + first, count, rho);
    load(row.slope_x + first, count, slope_x);
    load(row.slope_y + first, count, slope_y);
    for (const float* const quadrant : row.quadrants) {
      const float* of[kVariance + 1];
      for (int k = 0; k <= kVariance; ++k) of[k] = quadrant + row.stride * k + first;
      for (int l = 0; l < kLanes; ++l) {
        const float n = of[kPixels][l];
        supported[l] += n > kLeastOfQuadrant ? 1 : 0;
        by_sfm[l] += of[kOfSfm][l] > kLeastOfQuadrant ? 1 : 0;
        least[l] = lesser(n, least[l]);
        all[l] += n;
        variance[l] += of[kVariance][l];
        const float plane = rho[l] + slope_x[l] * (of[kX][l] / n - grid.middleX(first + l)) +
                            slope_y[l] * (of[kY][l] / n - row.middle_y);
        const float off = n > kTrace ? std::abs(of[kRho][l] / n - plane) : 0.0F;
        offset[l] = greater(off, offset[l]);
      }
    }
    for (int l = 0; l < count; ++l) {
      const int column = first + l;
      const bool exists = rho[l] > 0.0F, is_wide = row.is_wide[column] != 0;
      const float common = variances[column];
      const bool fits = (misfits[column] < square(kLargestMisfit) + common / Evidence::kShare) &
                        (offset[l] < kStep * rho[l]);
      const bool is_between = fits & (by_sfm[l] >= kFewestQuadrants);
      const bool is_in_gap = fits & (least[l] > kLeastOfRim) & !is_wide;
      // In a wide hole, the sensor's depth at the rim does not tell.
      const bool is_confirmed = is_between | (fits & (supported[l] >= kFewestQuadrants) & !is_wide);
      known[column] = exists & ((row.source[column] != Source::kNone) | is_confirmed) ? 1 : 0;
      const auto found = is_between ? Surfaces::kBetweenSfm : is_in_gap ? Surfaces::kInGap : Surfaces::kNot;
      const bool is_wanted = drawn[column] != Surfaces::kNot;
      drawn[column] = static_cast<std::uint8_t>(exists & is_wanted ? found : Surfaces::kNot);
      const float of_surface = misfits[column] * (1.0F + (1.0F + row.lever[column]) / all[l]);
      misfits[column] = exists ? of_surface : misfits[column];
      const float of_all = variance[l] / all[l];
      variances[column] = drawn[column] == Surfaces::kInGap ? greater(of_all, common) : common;
    }
  }
}

}  // namespace

const Surfaces& SurfaceDrawing::draw(const CellGrid& grid, const cv::Mat_<std::uint8_t>& grey,
                                     const CellLinks& image_links, const Supports& supports,
                                     const std::vector<std::uint8_t>& wanted, float disparity) {
  const std::size_t count = grid.size();
  for (std::vector<float>* values : {&surfaces_.rho, &surfaces_.slope_x, &surfaces_.slope_y,
                                     &surfaces_.misfit, &surfaces_.variance, &surfaces_.other})
    values->assign(count, 0.0F);
  surfaces_.drawn = wanted;
  near_ = wanted;
  cv::Mat_<std::uint8_t> near(grid.rows, grid.columns, near_.data());
  cv::dilate(near, near, cv::Mat::ones(2 * kMargin + 1, 2 * kMargin + 1, CV_8U));
  weights_.resize(count);
  for (std::size_t cell = 0; cell < count; ++cell)
    weights_[cell] = supports.isOfSfm(cell) ? 1.0F : kSensorAtFirst;
  fit(grid, image_links, supports, false);
  for (int round = 0; round < kRounds; ++round) {
    doubt(grid, image_links, supports);
    fit(grid, links_, supports, round + 1 == kRounds);
  }
  judge(grid, supports);
  keepOffSteps(grid);
  continueInShadows(grid, grey, supports, wanted, disparity);
  lookAround(grid, grey);
  keepToContours(grid, grey, supports, wanted);
  return surfaces_;
}

void SurfaceDrawing::doubt(const CellGrid& grid, const CellLinks& image_links, const Supports& supports) {
  links_ = image_links;
  for (int row = 0; row < grid.rows; ++row) {
    const std::size_t first = grid.index(row, 0);
    const std::uint8_t* const near = near_.data() + first;
    const float* const middles = middle_.data() + first;
    // Depth that is withheld keeps its weight: where it contradicts the plane, nothing should be drawn.
    doubtSupports(near, supports.source.data() + first, middles, supports.own.data() + first,
                  surfaces_.rho.data() + first, grid.columns, weights_.data() + first);
    cutLinks(near, middles, surfaces_.slope_x.data() + first, 1, grid.columns - 1,
             links_.right.data() + first);
    if (row + 1 == grid.rows) continue;
    cutLinks(near, middles, surfaces_.slope_y.data() + first, grid.columns, grid.columns,
             links_.below.data() + first);
  }
}

void SurfaceDrawing::judge(const CellGrid& grid, const Supports& supports) {
  const auto fill_row = [&](int row, float* values) {
    for (std::size_t cell = grid.index(row, 0); cell < grid.index(row + 1, 0);
         ++cell, values += kQuadrantLanes) {
      if (supports.source[cell] == Source::kNone) {
        std::fill_n(values, kQuadrantLanes, 0.0F);
        continue;
      }
      values[kPixels] = 1.0F;
      values[kX] = supports.x[cell];
      values[kY] = supports.y[cell];
      values[kRho] = supports.rho[cell];
      values[kOfSfm] = supports.isOfSfm(cell) ? weights_[cell] : 0.0F;
      values[kVariance] = supports.variance[cell];
    }
  };
  const cv::Mat_<std::uint8_t> wide = wideHoles(cellsWithout(grid, supports));
  known_.resize(grid.size());
  const auto judge_row = [&](int row, const std::array<const float*, 4>& quadrants) {
    const std::size_t first = grid.index(row, 0);
    judgePlanes(
        grid,
        {quadrants, static_cast<int>(LinkedSums::stride(grid)), surfaces_.rho.data() + first,
         surfaces_.slope_x.data() + first, surfaces_.slope_y.data() + first, levers_.data() + first,
         supports.source.data() + first, near_.data() + first, wide[row], grid.middleY(row), grid.columns},
        known_.data() + first, surfaces_.drawn.data() + first, surfaces_.misfit.data() + first,
        surfaces_.variance.data() + first);
  };
  sums_.overQuadrants(grid, links_, kVariance + 1, fill_row, judge_row);
}

}  // namespace rgbd_sfm_fusion
