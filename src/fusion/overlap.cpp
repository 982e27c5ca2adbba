// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/overlap.h"

#include <algorithm>
#include <limits>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

RGBD_SFM_FUSION_MULTIVERSION
int countBothRow(const float* a, const float* b, int width) {
  int count = 0;
  for (int x = 0; x < width; ++x) count += ((a[x] > 0.0f) & (b[x] > 0.0f)) ? 1 : 0;
  return count;
}

std::size_t countBoth(const DepthImage& a, const DepthImage& b) {
  std::size_t count = 0;
  for (int y = 0; y < a.rows; ++y) count += static_cast<std::size_t>(countBothRow(a[y], b[y], a.cols));
  return count;
}

void reserve(std::size_t size, Overlap* overlap) {
  for (std::vector<float>* values :
       {&overlap->sfm, &overlap->sfm_variance, &overlap->sensor, &overlap->sensor_variance}) {
    values->reserve(size);
  }
  overlap->tile.reserve(size);
}

}  // namespace

Overlap collectOverlap(const GaussianDepth& sfm, const GaussianDepth& sensor, std::size_t max_samples) {
  Overlap overlap;
  const int width = sfm.mean.cols, height = sfm.mean.rows;
  overlap.pixels = countBoth(sfm.mean, sensor.mean);
  const std::size_t wanted = max_samples == 0 ? overlap.pixels : max_samples;
  if (overlap.pixels == 0) return overlap;
  // Odd, so that it walks over all columns of an image of even width.
  const int stride = static_cast<int>((overlap.pixels - 1) / wanted / 2 * 2 + 1);
  reserve(overlap.pixels / static_cast<std::size_t>(stride) * 5 / 4 + 64, &overlap);
  int x = 0;
  for (int y = 0; y < height; ++y) {
    const int tile_row = y * Overlap::kTileRows / height * Overlap::kTileColumns;
    for (; x < width; x += stride) {
      const float mu = sfm.mean(y, x), d = sensor.mean(y, x);
      if (!((mu > 0.0f) & (d > 0.0f))) continue;
      overlap.sfm.push_back(mu);
      overlap.sfm_variance.push_back(sfm.variance(y, x));
      overlap.sensor.push_back(d);
      overlap.sensor_variance.push_back(sensor.variance(y, x));
      overlap.tile.push_back(static_cast<std::uint8_t>(tile_row + x * Overlap::kTileColumns / width));
    }
    x -= width;
  }
  return overlap;
}

double sfmVarianceFactor(const Overlap& overlap, double alpha, std::size_t min_pixels) {
  constexpr float kMedianOfChiSquared = 0.4549f;  // with one degree of freedom
  std::vector<float> ratios;
  ratios.reserve(overlap.size());
  const auto scale = static_cast<float>(alpha);
  for (std::size_t i = 0; i < overlap.size(); ++i) {
    const float variance = scale * scale * overlap.sfm_variance[i];
    if (!(variance > overlap.sensor_variance[i])) continue;
    const float difference = overlap.sensor[i] - scale * overlap.sfm[i];
    ratios.push_back(difference * difference / (variance + overlap.sensor_variance[i]));
  }
  if (ratios.size() < std::max<std::size_t>(min_pixels, 1)) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  return std::clamp(static_cast<double>(*middle / kMedianOfChiSquared), 0.25, 100.0);
}

}  // namespace rgbd_sfm_fusion
