// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/sensor/stray_depth.h"

#include <array>
#include <opencv2/core.hpp>

#include "rgbd_sfm_fusion/multiversion.h"
#include "rgbd_sfm_fusion/sensor/lateral_variance.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kReach = 3;  // [px]

/// The nearest depth among three: the first one that exists. NaN: there is none.
inline float nearest(float first, float second, float third) {
  const float last = third > 0.0F ? third : kNoDepth, behind = second > 0.0F ? second : last;
  return first > 0.0F ? first : behind;
}

/// The nearest depth from a pixel on, in steps. NaN: there is none within kReach.
float nearestFrom(const DepthImage& measured, const cv::Point& pixel, const cv::Point& step) {
  cv::Point at = pixel;
  for (int i = 1; i <= kReach; ++i) {
    at += step;
    if (at.x < 0 || at.y < 0 || at.x >= measured.cols || at.y >= measured.rows) break;
    if (measured(at) > 0.0F) return measured(at);
  }
  return kNoDepth;
}

/// [m²] Largest squared difference of depths of one surface.
inline float largestOfSurface(float z, const DepthNoiseModel& noise) {
  const float sigma = noise.sigmaZ(z), relative = kStepRatio * kStepRatio * z * z,
              by_noise = 9.0F * (sigma * sigma + noise.floor * noise.floor);
  return relative > by_noise ? relative : by_noise;
}

/// @param rows  from kReach above the row to kReach below; readable from -kReach to width - 1 + kReach
RGBD_SFM_FUSION_MULTIVERSION
void removeOfRow(const std::array<const float*, 2 * kReach + 1>& rows, int width, const DepthNoiseModel noise,
                 float* __restrict mean, float* __restrict variance) {
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
    const bool stays = in_row & in_column;
    mean[x] = stays ? mean[x] : kNoDepth;
    variance[x] = stays ? variance[x] : kNoDepth;
  }
}

}  // namespace

bool isSparse(const DepthImage& measured) {
  const int every = kReach + 2;  // [px] to save time; gaps of 2 or 4 px do not hide from it
  int depths = 0, alone = 0;
  for (int y = 0; y < measured.rows; y += every) {
    for (int x = 0; x < measured.cols; x += every) {
      if (!(measured(y, x) > 0.0F)) continue;
      const auto has = [&](int dx, int dy) { return nearestFrom(measured, {x, y}, {dx, dy}) > 0.0F; };
      const bool is_alone = !(has(-1, 0) || has(1, 0)) || !(has(0, -1) || has(0, 1));
      ++depths, alone += is_alone ? 1 : 0;
    }
  }
  return 2 * alone > depths;
}

bool isStray(const DepthImage& measured, const cv::Point& pixel, const DepthNoiseModel& noise) {
  if (noise.lateral_sigma == 0.0F) return false;
  const float z = measured(pixel), limit = largestOfSurface(z, noise);
  const auto confirms = [&](int dx, int dy) {
    const float difference = nearestFrom(measured, pixel, {dx, dy}) - z;
    return difference * difference <= limit;  // false for NaN
  };
  return !(confirms(-1, 0) || confirms(1, 0)) || !(confirms(0, -1) || confirms(0, 1));
}

void removeStrays(const DepthImage& measured, const DepthNoiseModel& noise, GaussianDepth* depth) {
  if (noise.lateral_sigma == 0.0F || isSparse(measured)) return;
  cv::Mat_<float> padded;
  cv::copyMakeBorder(measured, padded, kReach, kReach, kReach, kReach, cv::BORDER_CONSTANT, 0.0);
  for (int y = 0; y < measured.rows; ++y) {
    std::array<const float*, 2 * kReach + 1> rows;
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = padded[y + static_cast<int>(i)] + kReach;
    removeOfRow(rows, measured.cols, noise, depth->mean[y], depth->variance[y]);
  }
}

}  // namespace rgbd_sfm_fusion
