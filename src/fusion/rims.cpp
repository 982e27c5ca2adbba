// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/rims.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "rgbd_sfm_fusion/find_byte.h"
#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// Adds to each column's count the depth of a row that comes near, and takes off that of one that no longer
/// is.
RGBD_SFM_FUSION_MULTIVERSION
void countNear(const float* coming, const float* going, int width, std::uint8_t* __restrict counts) {
  for (int x = 0; x < width; ++x) {
    const int change = (coming[x] > 0.0f ? 1 : 0) - (going[x] > 0.0f ? 1 : 0);
    counts[x] = static_cast<std::uint8_t>(counts[x] + change);
  }
}

RGBD_SFM_FUSION_MULTIVERSION
void addBits(const std::uint8_t* values, int width, std::uint8_t* __restrict sum) {
  for (int x = 0; x < width; ++x) sum[x] = static_cast<std::uint8_t>(sum[x] | values[x]);
}

/// 1 where there is something near, but nothing at the pixel itself.
RGBD_SFM_FUSION_MULTIVERSION
void markRims(const float* sensor, int width, std::uint8_t* __restrict near) {
  for (int x = 0; x < width; ++x)
    near[x] = static_cast<std::uint8_t>((near[x] != 0 ? 1 : 0) & (sensor[x] > 0.0f ? 0 : 1));
}

void drop(const std::vector<std::uint8_t>& rims, float* mean, float* variance) {
  const auto width = static_cast<int>(rims.size());
  for (int x = findByte(1, rims.data(), 0, width); x < width; x = findByte(1, rims.data(), x, width)) {
    for (; x < width && rims[static_cast<std::size_t>(x)] != 0; ++x) mean[x] = variance[x] = kNone;
  }
}

}  // namespace

void dropAtRims(const DepthImage& sensor, int width, GaussianDepth& sfm) {
  if (width == 0) return;
  const int rows = sensor.rows, columns = sensor.cols;
  const std::vector<float> none(static_cast<std::size_t>(columns), kNone);
  const auto row = [&](int y) { return y >= 0 && y < rows ? sensor[y] : none.data(); };
  // Of the rows near to the current one, with `width` columns beside the image.
  std::vector<std::uint8_t> counts(static_cast<std::size_t>(columns + 2 * width), 0);
  std::vector<std::uint8_t> rims(static_cast<std::size_t>(columns));
  for (int y = -width; y < rows; ++y) {
    countNear(row(y + width), row(y - width - 1), columns, counts.data() + width);
    if (y < 0) continue;
    std::fill(rims.begin(), rims.end(), std::uint8_t{0});
    for (int shift = 0; shift <= 2 * width; ++shift) addBits(counts.data() + shift, columns, rims.data());
    markRims(sensor[y], columns, rims.data());
    drop(rims, sfm.mean[y], sfm.variance[y]);
  }
}

}  // namespace rgbd_sfm_fusion
