// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/completion/surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "rgbd_sfm_fusion/fusion/evidence.h"

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
constexpr std::size_t kFewestQuadrants = 3;
constexpr float kSensorAtFirst = 1e-3F;  // weight of the sensor's supports before any surface is known
constexpr int kRounds = 2;               // of doubt
constexpr int kMargin = 3;               // [cells] around wanted cells in which steps are looked for
constexpr float kRoughness = 1e-4F;      // of inverse depth: variance that keeps sure supports from ruling
constexpr float kLeastSpread = 1e-5F;    // squared spread of a plane's supports

float square(float value) {
  return value * value;
}

/// A weight that is 1 at 0 and 1/4 at 1, and falls on.
float doubtful(float value) {
  return square(1.0F / (1.0F + square(value)));
}

/// Indices of the moments of a cell.
enum Moment { kW, kWx, kWy, kWxx, kWxy, kWyy, kWr, kWxr, kWyr, kWrr, kOfSfmW, kOfSfmWv };
enum Value { kPixels, kX, kY, kRho, kOfSfm, kVariance };
static_assert(kOfSfmWv < kMomentLanes && kVariance < kQuadrantLanes, "a lane for each");

/// A plane by weighted least squares.
struct Fit {
  float rho, slope_x, slope_y, misfit;
};

/// The prior of slopes is N(0, 2²) per unit, relative to rho. Without it, a few supports in a line would
/// leave one slope open.
Fit fitPlane(const float* m, float x, float y) {
  const float w = 1.0F / m[kW], mx = m[kWx] * w, my = m[kWy] * w, mr = m[kWr] * w;
  const float xx = m[kWxx] * w - mx * mx, xy = m[kWxy] * w - mx * my, yy = m[kWyy] * w - my * my;
  const float xr = m[kWxr] * w - mx * mr, yr = m[kWyr] * w - my * mr, rr = m[kWrr] * w - mr * mr;
  const float prior = 0.25F / (m[kW] * mr * mr) + kLeastSpread;
  const float a = std::max(xx, 0.0F) + prior, b = std::max(yy, 0.0F) + prior;
  const float determinant = std::max(a * b - xy * xy, prior * prior);
  const float gx = (b * xr - xy * yr) / determinant, gy = (a * yr - xy * xr) / determinant;
  const float dx = x - mx, dy = y - my;
  const float misfit = rr - 2.0F * (gx * xr + gy * yr) + gx * gx * xx + 2.0F * gx * gy * xy + gy * gy * yy;
  return {mr + gx * dx + gy * dy, gx, gy, std::max(misfit, 0.0F) / (mr * mr)};
}

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

/// What the supports in a cell's quadrants say of its plane.
struct Verdict {
  std::size_t supported = 0, by_sfm = 0;            // numbers of quadrants
  float least = std::numeric_limits<float>::max();  // supports of a quadrant, weighted by their links
  float all = 0.0F;                                 // supports, weighted by their links
  float variance = 0.0F;                            // [1] sum of the supports' variances, weighted likewise
  float offset = 0.0F;  // [1/m] largest distance of a quadrant's mean from the plane
};

}  // namespace

const Surfaces& SurfaceDrawing::draw(const CellGrid& grid, const CellLinks& image_links,
                                     const Supports& supports, const std::vector<std::uint8_t>& wanted,
                                     float disparity) {
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
  fit(grid, image_links, supports);
  for (int round = 0; round < kRounds; ++round) {
    doubt(grid, image_links, supports);
    fit(grid, links_, supports);
  }
  judge(grid, supports);
  keepOffSteps(grid);
  continueInShadows(grid, supports, wanted, disparity);
  lookAround(grid);
  return surfaces_;
}

void SurfaceDrawing::fit(const CellGrid& grid, const CellLinks& links, const Supports& supports) {
  const std::size_t count = grid.size(), lanes = kMomentLanes;
  moments_.resize(count * lanes);
  work_.resize(count * lanes);
  middle_.resize(count);
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
    for (int column = 0; column < grid.columns; ++column) fitCell(grid, supports, row, column);
  };
  sumAlongLinks(grid, links, moments_, work_, fill_row, fit_row);
}

void SurfaceDrawing::fitCell(const CellGrid& grid, const Supports& supports, int row, int column) {
  const std::size_t cell = grid.index(row, column);
  const float* moments = moments_.data() + static_cast<std::size_t>(kMomentLanes) * cell;
  surfaces_.rho[cell] = surfaces_.slope_x[cell] = surfaces_.slope_y[cell] = 0.0F;
  const bool is_sure = supports.isPublished(cell);
  middle_[cell] = is_sure ? supports.rho[cell] : 0.0F;
  if (near_[cell] == 0 || !(moments[kW] > 1e-20F)) return;
  const float x = grid.middleX(column), y = grid.middleY(row);
  const Fit plane = fitPlane(moments, x, y);
  if (!(plane.rho > 0.0F)) return;
  surfaces_.rho[cell] = plane.rho;
  surfaces_.slope_x[cell] = plane.slope_x;
  surfaces_.slope_y[cell] = plane.slope_y;
  surfaces_.misfit[cell] = plane.misfit;
  surfaces_.variance[cell] =
      moments[kOfSfmW] > 0.0F ? Evidence::kShare * moments[kOfSfmWv] / moments[kOfSfmW] : 0.0F;
  middle_[cell] = is_sure ? supports.rho[cell] + plane.slope_x * (x - supports.x[cell]) +
                                plane.slope_y * (y - supports.y[cell])
                          : plane.rho;
}

void SurfaceDrawing::doubt(const CellGrid& grid, const CellLinks& image_links, const Supports& supports) {
  links_ = image_links;
  for (float& weight : weights_) weight = 1.0F;
  const auto step = [](float a, float b) {
    const float farther = std::min(a, b);
    return farther > 0.0F ? doubtful((a - b) / (kStepScale * farther)) : 1.0F;
  };
  constexpr float kHalf = 0.5F * CellGrid::kSpacing;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const std::size_t cell = grid.index(row, column);
      if (near_[cell] == 0) continue;
      const float rho = surfaces_.rho[cell], here = middle_[cell];
      // Depth that is withheld keeps its weight: where it contradicts the plane, nothing should be drawn.
      if (supports.isPublished(cell) && rho > 0.0F)
        weights_[cell] = doubtful((here - rho) / (rho * std::sqrt(square(kStepScale) + supports.own[cell])));
      if (column + 1 < grid.columns && near_[cell + 1] != 0) {
        const float there = middle_[cell + 1];
        links_.right[cell] *=
            step(here + kHalf * surfaces_.slope_x[cell], there - kHalf * surfaces_.slope_x[cell + 1]);
      }
      const std::size_t next = cell + static_cast<std::size_t>(grid.columns);
      if (row + 1 < grid.rows && near_[next] != 0) {
        const float there = middle_[next];
        links_.below[cell] *=
            step(here + kHalf * surfaces_.slope_y[cell], there - kHalf * surfaces_.slope_y[next]);
      }
    }
  }
}

void SurfaceDrawing::judge(const CellGrid& grid, const Supports& supports) {
  const std::size_t count = grid.size(), lanes = kQuadrantLanes;
  values_.resize(count * lanes);
  const auto fill_row = [&](int row) {
    for (std::size_t cell = grid.index(row, 0); cell < grid.index(row + 1, 0); ++cell) {
      float* values = values_.data() + lanes * cell;
      if (supports.source[cell] == Source::kNone) {
        std::fill_n(values, lanes, 0.0F);
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
  known_.assign(count, 0);
  const auto judge_row = [&](int row) {
    for (int column = 0; column < grid.columns; ++column)
      judgeCell(grid, supports, wide(row, column) != 0, row, column);
  };
  sumQuadrants(grid, links_, values_, quadrants_, fill_row, judge_row);
}

void SurfaceDrawing::judgeCell(const CellGrid& grid, const Supports& supports, bool is_wide, int row,
                               int column) {
  const std::size_t cell = grid.index(row, column);
  const float rho = surfaces_.rho[cell];
  std::uint8_t& drawn = surfaces_.drawn[cell];
  if (drawn == Surfaces::kNot && supports.source[cell] != Source::kNone) {  // not wanted, and known
    known_[cell] = rho > 0.0F ? 1 : 0;
    return;
  }
  if (!(rho > 0.0F)) {
    drawn = Surfaces::kNot;
    return;
  }
  Verdict verdict;
  for (const std::vector<float>& quadrant : quadrants_) {
    const float* values = quadrant.data() + static_cast<std::size_t>(kQuadrantLanes) * cell;
    const float n = values[kPixels];
    verdict.supported += n > kLeastOfQuadrant ? 1 : 0;
    verdict.by_sfm += values[kOfSfm] > kLeastOfQuadrant ? 1 : 0;
    verdict.least = std::min(verdict.least, n);
    verdict.all += n;
    verdict.variance += values[kVariance];
    if (!(n > kTrace)) continue;
    const float plane = rho + surfaces_.slope_x[cell] * (values[kX] / n - grid.middleX(column)) +
                        surfaces_.slope_y[cell] * (values[kY] / n - grid.middleY(row));
    verdict.offset = std::max(verdict.offset, std::abs(values[kRho] / n - plane));
  }
  const bool fits =
      surfaces_.misfit[cell] < square(kLargestMisfit) + surfaces_.variance[cell] / Evidence::kShare &&
      verdict.offset < kStep * rho;
  const bool is_between = fits && verdict.by_sfm >= kFewestQuadrants;
  const bool is_in_gap = fits && verdict.least > kLeastOfRim && !is_wide;
  // In a wide hole, the sensor's depth at the rim does not tell.
  const bool is_confirmed = is_between || (fits && verdict.supported >= kFewestQuadrants && !is_wide);
  known_[cell] = supports.source[cell] != Source::kNone || is_confirmed ? 1 : 0;
  if (drawn == Surfaces::kNot) return;
  drawn = is_between ? Surfaces::kBetweenSfm : is_in_gap ? Surfaces::kInGap : Surfaces::kNot;
  if (drawn == Surfaces::kInGap)
    surfaces_.variance[cell] = std::max(surfaces_.variance[cell], verdict.variance / verdict.all);
}

}  // namespace rgbd_sfm_fusion
