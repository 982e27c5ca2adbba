// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/rims.h"

#include <algorithm>
#include <vector>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

RGBD_SFM_FUSION_MULTIVERSION
void markMeasuredRow(const float* variance, int width, std::uint8_t* __restrict measured) {
  for (int x = 0; x < width; ++x) measured[x] = variance[x] > 0.0f ? 1 : 0;
}

RGBD_SFM_FUSION_MULTIVERSION
void addRow(const std::uint8_t* measured, int width, std::uint8_t* __restrict near) {
  for (int x = 0; x < width; ++x) near[x] = near[x] | measured[x];
}

RGBD_SFM_FUSION_MULTIVERSION
void dropRow(const std::uint8_t* near, const std::uint8_t* measured, int width, float* __restrict mean,
             float* __restrict variance) {
  for (int x = 0; x < width; ++x) {
    const bool rim = (near[x] != 0) & (measured[x] == 0);
    mean[x] = rim ? kNoDepth : mean[x];
    variance[x] = rim ? kNoDepth : variance[x];
  }
}

}  // namespace

void dropAtRims(const GaussianDepth& sensor, int width, GaussianDepth& sfm) {
  if (width == 0) return;
  const cv::Size size = sfm.mean.size();
  cv::Mat_<std::uint8_t> measured(size);
  for (int y = 0; y < size.height; ++y) markMeasuredRow(sensor.variance[y], size.width, measured[y]);
  // Nothing is measured beyond the sides of the image.
  std::vector<std::uint8_t> column(static_cast<std::size_t>(size.width + 2 * width));
  std::vector<std::uint8_t> near(static_cast<std::size_t>(size.width));
  for (int y = 0; y < size.height; ++y) {
    std::fill(column.begin(), column.end(), std::uint8_t{0});
    for (int row = std::max(y - width, 0); row <= std::min(y + width, size.height - 1); ++row)
      addRow(measured[row], size.width, column.data() + width);
    std::fill(near.begin(), near.end(), std::uint8_t{0});
    for (int x = 0; x <= 2 * width; ++x) addRow(column.data() + x, size.width, near.data());
    dropRow(near.data(), measured[y], size.width, sfm.mean[y], sfm.variance[y]);
  }
}

}  // namespace rgbd_sfm_fusion
