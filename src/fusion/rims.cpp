// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/rims.h"

#include <algorithm>

#include "rgbd_sfm_fusion/find_byte.h"
#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

RGBD_SFM_FUSION_MULTIVERSION
void markRow(const float* variance, int width, std::uint8_t* __restrict marks) {
  for (int x = 0; x < width; ++x) marks[x] = variance[x] > 0.0f ? 1 : 0;
}

RGBD_SFM_FUSION_MULTIVERSION
void addBits(const std::uint8_t* values, int width, std::uint8_t* __restrict sum) {
  for (int x = 0; x < width; ++x) sum[x] = static_cast<std::uint8_t>(sum[x] | values[x]);
}

/// 1 where sensor depth is near, but not at the pixel itself.
RGBD_SFM_FUSION_MULTIVERSION
void findRimsRow(const std::uint8_t* marks, const std::uint8_t* near, int width,
                 std::uint8_t* __restrict rims) {
  for (int x = 0; x < width; ++x) rims[x] = static_cast<std::uint8_t>(near[x] & ~marks[x]);
}

void drop(const std::vector<std::uint8_t>& rims, float* mean, float* variance) {
  const auto width = static_cast<int>(rims.size());
  for (int x = findByte(1, rims.data(), 0, width); x < width; x = findByte(1, rims.data(), x, width)) {
    for (; x < width && rims[static_cast<std::size_t>(x)] != 0; ++x) mean[x] = variance[x] = kNoDepth;
  }
}

}  // namespace

void Rims::find(const GaussianDepth& sensor, int width) {
  const int rows = sensor.variance.rows, columns = sensor.variance.cols;
  marks_.create(rows, columns);
  near_.create(rows, columns);
  near_.setTo(0.0);
  if (width == 0) return;
  for (int y = 0; y < rows; ++y) markRow(sensor.variance[y], columns, marks_[y]);
  // Marks of all rows near to the current row, with `width` columns of margin on both sides.
  rows_.resize(static_cast<std::size_t>(columns + 2 * width));
  for (int y = 0; y < rows; ++y) {
    std::fill(rows_.begin(), rows_.end(), std::uint8_t{0});
    for (int row = std::max(0, y - width); row <= std::min(rows - 1, y + width); ++row)
      addBits(marks_[row], columns, rows_.data() + width);
    for (int shift = 0; shift <= 2 * width; ++shift) addBits(rows_.data() + shift, columns, near_[y]);
  }
}

void Rims::dropInHoles(GaussianDepth& sfm) const {
  std::vector<std::uint8_t> rims(static_cast<std::size_t>(near_.cols));
  for (int y = 0; y < near_.rows; ++y) {
    findRimsRow(marks_[y], near_[y], near_.cols, rims.data());
    drop(rims, sfm.mean[y], sfm.variance[y]);
  }
}

}  // namespace rgbd_sfm_fusion
