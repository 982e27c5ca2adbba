// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/sensor/stray_depth.h"

#include <algorithm>
#include <array>
#include <vector>

#include "rgbd_sfm_fusion/multiversion.h"
#include "rgbd_sfm_fusion/sensor/lateral_variance.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kReach = 3;  // [px]

/// Whether there is depth within kReach from a pixel on, in steps.
bool hasDepth(const DepthImage& measured, cv::Point at, const cv::Point& step) {
  for (int i = 1; i <= kReach; ++i) {
    at += step;
    if (at.x < 0 || at.y < 0 || at.x >= measured.cols || at.y >= measured.rows) break;
    if (measured(at) > 0.0F) return true;
  }
  return false;
}

/// Whether most depths have none around, in their row or in their column.
bool isSparse(const DepthImage& measured) {
  const int every = kReach + 2;  // [px] to save time; gaps of 2 or 4 px do not hide from it
  int depths = 0, alone = 0;
  for (int y = 0; y < measured.rows; y += every) {
    for (int x = 0; x < measured.cols; x += every) {
      if (!(measured(y, x) > 0.0F)) continue;
      const auto has = [&](int dx, int dy) { return hasDepth(measured, {x, y}, {dx, dy}); };
      const bool is_alone = !(has(-1, 0) || has(1, 0)) || !(has(0, -1) || has(0, 1));
      ++depths, alone += is_alone ? 1 : 0;
    }
  }
  return 2 * alone > depths;
}

/// The nearest depth among three: the first one that exists. NaN: there is none.
inline float nearest(float first, float second, float third) {
  const float last = third > 0.0F ? third : kNoDepth, behind = second > 0.0F ? second : last;
  return first > 0.0F ? first : behind;
}

/// [m²] Largest squared difference of depths of one surface.
inline float largestOfSurface(float z, const DepthNoiseModel& noise) {
  const float sigma = noise.sigmaZ(z), relative = kStepRatio * kStepRatio * z * z,
              by_noise = 9.0F * (sigma * sigma + noise.floor * noise.floor);
  return relative > by_noise ? relative : by_noise;
}

/// @param rows  from kReach above the row to kReach below; the row itself is readable from -kReach to
///              width - 1 + kReach
RGBD_SFM_FUSION_MULTIVERSION
void sortRow(const std::array<const float*, 2 * kReach + 1>& rows, int width, const DepthNoiseModel noise,
             float* __restrict confirmed, float* __restrict credible) {
  const float *const row = rows[3], *const up1 = rows[2], *const up2 = rows[1], *const up3 = rows[0],
                     *const down1 = rows[4], *const down2 = rows[5], *const down3 = rows[6];
  for (int x = 0; x < width; ++x) {
    const float z = row[x], limit = largestOfSurface(z, noise);
    const float left = nearest(row[x - 1], row[x - 2], row[x - 3]) - z,
                right = nearest(row[x + 1], row[x + 2], row[x + 3]) - z,
                above = nearest(up1[x], up2[x], up3[x]) - z,
                below = nearest(down1[x], down2[x], down3[x]) - z;
    const bool in_row = (left * left <= limit) | (right * right <= limit);  // false for NaN
    const bool in_column = (above * above <= limit) | (below * below <= limit);
    const bool is_contradicted =
        (left * left > limit) | (right * right > limit) | (above * above > limit) | (below * below > limit);
    confirmed[x] = in_row & in_column ? z : kNoDepth;
    credible[x] = in_row | in_column | !is_contradicted ? z : kNoDepth;
  }
}

}  // namespace

SortedDepth sortStrays(const DepthImage& measured, const DepthNoiseModel& noise, SortedDepth buffer) {
  if (noise.lateral_sigma == 0.0F || isSparse(measured)) return {measured, measured};
  buffer.confirmed.create(measured.size());
  buffer.credible.create(measured.size());
  const auto width = static_cast<std::size_t>(measured.cols);
  const std::vector<float> beyond(width, kNoDepth);
  std::vector<float> padded(width + 2 * kReach, kNoDepth);
  for (int y = 0; y < measured.rows; ++y) {
    std::array<const float*, 2 * kReach + 1> rows;
    for (int i = -kReach; i <= kReach; ++i) {
      const bool exists = y + i >= 0 && y + i < measured.rows;
      rows[static_cast<std::size_t>(kReach + i)] = exists ? measured[y + i] : beyond.data();
    }
    std::copy_n(measured[y], width, padded.begin() + kReach);
    rows[kReach] = padded.data() + kReach;
    sortRow(rows, measured.cols, noise, buffer.confirmed[y], buffer.credible[y]);
  }
  return buffer;
}

}  // namespace rgbd_sfm_fusion
