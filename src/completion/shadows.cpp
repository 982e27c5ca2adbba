// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "rgbd_sfm_fusion/completion/surfaces.h"

namespace rgbd_sfm_fusion {
namespace {

using Source = Supports::Source;

constexpr float kWindow = 9.0F;  // [px] width of the window in which the sensor matches its pattern

}  // namespace

void SurfaceDrawing::continueInShadows(const CellGrid& grid, const cv::Mat_<std::uint8_t>& grey,
                                       const Supports& supports, const std::vector<std::uint8_t>& wanted,
                                       float disparity) {
  for (int row = 0; row < grid.rows; ++row) {
    const auto isMeasured = [&](int x) { return supports.source[grid.index(row, x)] == Source::kSensor; };
    int left = -1;  // the last cell that the sensor sees
    for (int x = 0; x < grid.columns; ++x) {
      if (!isMeasured(x)) continue;
      if (left >= 0 && x > left + 1) continueInRun(grid, grey, supports, wanted, disparity, row, left, x);
      left = x;
    }
  }
}

void SurfaceDrawing::continueInRun(const CellGrid& grid, const cv::Mat_<std::uint8_t>& grey,
                                   const Supports& supports, const std::vector<std::uint8_t>& wanted,
                                   float disparity, int row, int left, int right) {
  const std::size_t first = grid.index(row, left), last = grid.index(row, right);
  const bool far_is_left = supports.rho[first] < supports.rho[last];
  const std::size_t far = far_is_left ? first : last;
  const float rho_near = supports.rho[far_is_left ? last : first];
  const int far_column = far_is_left ? left : right;
  const float rho_far = surfaces_.rho[far], slope_x = surfaces_.slope_x[far];
  if (!(rho_far > 0.0F) || std::abs(rho_far - supports.rho[far]) > kSurfaceStep * rho_far) return;
  const auto planeAt = [&](int column) {
    return rho_far + slope_x * CellGrid::kSpacing * static_cast<float>(column - far_column);
  };
  const float behind = planeAt(far_is_left ? right : left);  // far plane, where the nearer side begins
  const auto length = static_cast<float>(CellGrid::kSize * (right - left - 1));
  if (!(behind > 0.0F) || behind > (1.0F + kSurfaceStep) * rho_near ||
      length > kWindow + disparity * std::max(0.0F, rho_near - behind))
    return;
  for (int x = left + 1; x < right; ++x) {
    const std::size_t cell = grid.index(row, x);
    const bool has_sfm = supports.isOfSfm(cell);
    if (has_sfm && std::abs(supports.rho[cell] - planeAt(x)) > kSurfaceStep * planeAt(x)) return;
  }
  const bool is_step = rho_near > (1.0F + kSurfaceStep) * behind;
  const int end = far_is_left ? right : left, step = far_is_left ? 1 : -1;
  for (int x = far_column + step; x != end; x += step) {
    const std::size_t cell = grid.index(row, x);
    if (std::abs(grey(row, x) - grey(row, x - step)) > kEdge) return;
    if (wanted[cell] == 0 || surfaces_.drawn[cell] != Surfaces::kNot) continue;
    // The cell beside the nearer side may belong to that side.
    if (is_step && right - left > 2 && x == end - step) continue;
    surfaces_.rho[cell] = planeAt(x);
    surfaces_.slope_x[cell] = slope_x;
    surfaces_.slope_y[cell] = surfaces_.slope_y[far];
    surfaces_.misfit[cell] = surfaces_.misfit[far];
    surfaces_.variance[cell] = supports.variance[far];
    surfaces_.drawn[cell] = Surfaces::kInShadow;
  }
}

}  // namespace rgbd_sfm_fusion
