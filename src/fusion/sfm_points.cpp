// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/sfm_points.h"

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

/// Takes every `stride`-th pixel that has both depths.
void sample(const GaussianDepth& sfm, const GaussianDepth& sensor, const PinholeCamera& camera,
            float farthest, std::size_t stride, Overlap* overlap) {
  const int width = sfm.mean.cols, height = sfm.mean.rows;
  RowPoints points(width);
  std::size_t until_next = 0;
  for (int y = 0; y < height; ++y) {
    const int tile_row = y * Overlap::kTileRows / height * Overlap::kTileColumns;
    const float* const d = sensor.mean[y];
    const auto ray_y = static_cast<float>((y - camera.cy) / camera.fy);
    points.gather(sfm.mean[y]);
    for (std::size_t i = 0; i < points.count; ++i) {
      const int x = points.columns[i];
      if (!(d[x] <= farthest) || until_next-- != 0) continue;
      until_next = stride - 1;
      overlap->sfm.push_back(points.values[i]);
      overlap->sfm_variance.push_back(sfm.variance(y, x));
      overlap->sensor.push_back(d[x]);
      overlap->sensor_variance.push_back(sensor.variance(y, x));
      overlap->x.push_back(static_cast<float>((x - camera.cx) / camera.fx));
      overlap->y.push_back(ray_y);
      overlap->tile.push_back(static_cast<std::uint8_t>(tile_row + x * Overlap::kTileColumns / width));
    }
  }
}

/// Copies the values of a row at these columns; NaN if there is no row.
void take(const int* columns, std::size_t count, const float* row, float* values) {
  if (row == nullptr) {
    std::fill_n(values, count, kNoDepth);
    return;
  }
  for (std::size_t i = 0; i < count; ++i) values[i] = row[columns[i]];
}

}  // namespace

void SfmPoints::collect(const SensorDepth& of_sensor, const GaussianDepth& of_sfm) {
  const cv::Size size = of_sensor.depth.mean.size();
  rows_.assign(static_cast<std::size_t>(size.height) + 1, 0);
  if (of_sfm.mean.empty()) return;
  if (size.width != width_ || columns.size() < static_cast<std::size_t>(size.area())) grow(size);
  std::size_t found = 0;
  for (int y = 0; y < size.height; ++y) {
    row_.gather(of_sfm.mean[y]);
    const std::size_t count = row_.count;
    std::copy_n(row_.columns.begin(), count, columns.data() + found);
    std::copy_n(row_.values.begin(), count, sfm.data() + found);
    const auto takeAll = [&](const float* row, std::vector<float>& values) {
      take(row_.columns.data(), count, row, values.data() + found);
    };
    takeAll(of_sfm.variance[y], sfm_variance);
    takeAll(of_sensor.depth.mean[y], sensor);
    takeAll(of_sensor.depth.variance[y], sensor_variance);
    takeAll(of_sensor.surfaceVariance()[y], surface_variance);
    takeAll(of_sensor.of_any_range.empty() ? nullptr : of_sensor.of_any_range[y], of_any_range);
    found += count;
    rows_[static_cast<std::size_t>(y) + 1] = found;
  }
}

void SfmPoints::grow(const cv::Size& size) {
  width_ = size.width;
  row_ = RowPoints(width_);
  const auto pixels = static_cast<std::size_t>(size.area());
  columns.resize(pixels);
  for (std::vector<float>* values :
       {&sfm, &sfm_variance, &sensor, &sensor_variance, &surface_variance, &of_any_range}) {
    values->resize(pixels);
  }
}

double Overlap::adjacency(std::size_t i, std::size_t j) {
  constexpr auto kColumns = static_cast<std::size_t>(kTileColumns);
  const auto gap = [](std::size_t a, std::size_t b) { return a > b ? a - b : b - a; };
  const std::size_t columns = gap(i % kColumns, j % kColumns), rows = gap(i / kColumns, j / kColumns);
  return columns > 1 || rows > 1 ? 0.0 : (columns == 0 ? 1.0 : 0.5) * (rows == 0 ? 1.0 : 0.5);
}

Overlap collectOverlap(const GaussianDepth& sfm, const GaussianDepth& sensor, const PinholeCamera& camera,
                       float farthest, std::size_t max_samples) {
  Overlap overlap;
  overlap.pixels = countBoth(sfm.mean, sensor.mean, farthest);
  if (overlap.pixels == 0) return overlap;
  const std::size_t stride = max_samples == 0 ? 1 : (overlap.pixels - 1) / max_samples + 1;
  reserve(overlap.pixels / stride + 1, &overlap);
  sample(sfm, sensor, camera, farthest, stride, &overlap);
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
