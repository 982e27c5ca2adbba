// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/overlap.h"

#include <algorithm>
#include <cmath>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

RGBD_SFM_FUSION_MULTIVERSION
int countBothRow(const float* sfm, const float* sensor, float farthest, int width) {
  int count = 0;
  for (int x = 0; x < width; ++x) count += ((sfm[x] > 0.0f) & (sensor[x] <= farthest)) ? 1 : 0;
  return count;
}

std::size_t countBoth(const DepthImage& sfm, const DepthImage& sensor, float farthest) {
  std::size_t count = 0;
  for (int y = 0; y < sfm.rows; ++y)
    count += static_cast<std::size_t>(countBothRow(sfm[y], sensor[y], farthest, sfm.cols));
  return count;
}

void reserve(std::size_t size, Overlap* overlap) {
  for (std::vector<float>* values : {&overlap->sfm, &overlap->sfm_variance, &overlap->sensor,
                                     &overlap->sensor_variance, &overlap->x, &overlap->y}) {
    values->reserve(size);
  }
  overlap->tile.reserve(size);
}

/// Takes every `stride`-th pixel of every `row_step`-th row, if it has both depths.
void sample(const GaussianDepth& sfm, const GaussianDepth& sensor, const PinholeCamera& camera,
            float farthest, int stride, int row_step, Overlap* overlap) {
  const int width = sfm.mean.cols, height = sfm.mean.rows;
  int x = 0;
  for (int y = 0; y < height; y += row_step) {
    const int tile_row = y * Overlap::kTileRows / height * Overlap::kTileColumns;
    const float *mu = sfm.mean[y], *d = sensor.mean[y];
    const auto ray_y = static_cast<float>((y - camera.cy) / camera.fy);
    for (; x < width; x += stride) {
      if (!((mu[x] > 0.0f) & (d[x] <= farthest))) continue;
      overlap->sfm.push_back(mu[x]);
      overlap->sfm_variance.push_back(sfm.variance(y, x));
      overlap->sensor.push_back(d[x]);
      overlap->sensor_variance.push_back(sensor.variance(y, x));
      overlap->x.push_back(static_cast<float>((x - camera.cx) / camera.fx));
      overlap->y.push_back(ray_y);
      overlap->tile.push_back(static_cast<std::uint8_t>(tile_row + x * Overlap::kTileColumns / width));
    }
    x -= width;
  }
}

/// The stride is odd, so that the samples walk over all columns of an image of even width.
int oddStride(std::size_t pixels, std::size_t samples) {
  return static_cast<int>((pixels - 1) / samples / 2 * 2 + 1);
}

}  // namespace

double Overlap::adjacency(std::size_t i, std::size_t j) {
  constexpr auto kColumns = static_cast<std::size_t>(kTileColumns);
  const auto gap = [](std::size_t a, std::size_t b) { return a > b ? a - b : b - a; };
  const std::size_t columns = gap(i % kColumns, j % kColumns), rows = gap(i / kColumns, j / kColumns);
  return columns > 1 || rows > 1 ? 0.0 : (columns == 0 ? 1.0 : 0.5) * (rows == 0 ? 1.0 : 0.5);
}

Overlap collectOverlap(const GaussianDepth& sfm, const GaussianDepth& sensor, const PinholeCamera& camera,
                       float farthest, std::size_t max_samples) {
  // A semi-dense image usually covers a fourth of the frame. If it does, the overlap need not be counted.
  // Whole rows are left out, since fetching rows is what takes time.
  constexpr std::size_t kPart = 4;
  constexpr int kRowStep = 4;
  Overlap overlap;
  if (max_samples > 0) {
    const int stride = oddStride(sfm.mean.total() / kRowStep, kPart * max_samples);
    reserve(max_samples, &overlap);
    sample(sfm, sensor, camera, farthest, stride, kRowStep, &overlap);
    overlap.pixels = overlap.size() * static_cast<std::size_t>(stride * kRowStep);
    if (overlap.size() >= max_samples / kPart) return overlap;
    overlap = {};
  }
  overlap.pixels = countBoth(sfm.mean, sensor.mean, farthest);
  if (overlap.pixels == 0) return overlap;
  const int stride = oddStride(overlap.pixels, max_samples == 0 ? overlap.pixels : max_samples);
  reserve(overlap.pixels / static_cast<std::size_t>(stride) * 5 / 4 + 64, &overlap);
  sample(sfm, sensor, camera, farthest, stride, 1, &overlap);
  return overlap;
}

std::array<double, Overlap::kTiles> Overlap::meanInverseDepthSigma() const {
  std::array<double, kTiles> sum{}, count{};
  for (std::size_t i = 0; i < size(); ++i) {
    sum[tile[i]] += static_cast<double>(std::sqrt(sfm_variance[i]) / (sfm[i] * sfm[i]));
    count[tile[i]] += 1.0;
  }
  for (std::size_t i = 0; i < kTiles; ++i) sum[i] /= std::max(count[i], 1.0);
  return sum;
}

}  // namespace rgbd_sfm_fusion
