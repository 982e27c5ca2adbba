// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/sfm_points.h"

#include <algorithm>
#include <cmath>

#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

void resize(std::size_t size, Overlap* overlap) {
  for (std::vector<float>* values : {&overlap->sfm, &overlap->sfm_variance, &overlap->sensor,
                                     &overlap->sensor_variance, &overlap->x, &overlap->y}) {
    values->resize(size);
  }
  overlap->tile.resize(size);
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

void SfmPoints::collect(const GaussianDepth& depth, const DepthImage& of_sensor) {
  rows_.assign(static_cast<std::size_t>(of_sensor.rows) + 1, 0);
  if (depth.mean.empty()) return;
  if (of_sensor.cols != width_ || columns.size() < of_sensor.total() + kLanes) grow(of_sensor.size());
  std::size_t found = 0;
  for (int y = 0; y < of_sensor.rows; ++y) {
    const int* const of_row = columns.data() + found;
    const std::size_t count = row_.find(depth.mean[y], columns.data() + found);
    take(of_row, count, depth.mean[y], sfm.data() + found);
    take(of_row, count, depth.variance[y], sfm_variance.data() + found);
    take(of_row, count, of_sensor[y], sensor.data() + found);
    found += count;
    rows_[static_cast<std::size_t>(y) + 1] = found;
  }
}

void SfmPoints::drop(const cv::Mat_<std::uint8_t>& marked, GaussianDepth* depth) {
  std::size_t kept = 0, i = 0;
  for (int y = 0; y < marked.rows; ++y) {
    float *const mean = depth->mean[y], *const variance = depth->variance[y];
    const std::uint8_t* const marks = marked[y];
    for (const std::size_t end_of_row = end(y); i < end_of_row; ++i) {
      const int x = columns[i];
      const bool keep = (marks[x] == 0) & (sfm[i] > 0.0f);
      mean[x] = keep ? sfm[i] : kNoDepth;
      variance[x] = keep ? sfm_variance[i] : kNoDepth;
      columns[kept] = x;
      sfm[kept] = sfm[i];
      sfm_variance[kept] = sfm_variance[i];
      sensor[kept] = sensor[i];
      kept += keep ? 1u : 0u;
    }
    rows_[static_cast<std::size_t>(y) + 1] = kept;
  }
}

void SfmPoints::compare(const SensorDepth& with) {
  const cv::Mat_<float>& of_surface = with.surfaceVariance();
  for (int y = 0; y + 1 < static_cast<int>(rows_.size()); ++y) {
    const std::size_t first = begin(y), count = end(y) - first;
    const auto takeAll = [&](const float* row, std::vector<float>& values) {
      take(columns.data() + first, count, row, values.data() + first);
    };
    takeAll(with.depth.variance[y], sensor_variance);
    takeAll(of_surface[y], surface_variance);
    takeAll(with.of_any_range.empty() ? nullptr : with.of_any_range[y], of_any_range);
  }
}

void SfmPoints::grow(const cv::Size& size) {
  width_ = size.width;
  row_ = RowPoints(width_);
  const auto pixels = static_cast<std::size_t>(size.area() + kLanes);
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

Overlap collectOverlap(const SfmPoints& points, const cv::Mat_<float>& sensor_variance,
                       const PinholeCamera& camera, float farthest, std::size_t max_samples) {
  Overlap overlap;
  const std::size_t stride = max_samples == 0 ? 1 : points.size() / max_samples + 1;
  resize(points.size() / stride + 1, &overlap);
  const int width = sensor_variance.cols, height = sensor_variance.rows;
  std::size_t found = 0, i = 0;
  for (int y = 0; y < height; ++y) {
    const int tile_row = y * Overlap::kTileRows / height * Overlap::kTileColumns;
    const auto ray_y = static_cast<float>((y - camera.cy) / camera.fy);
    for (const std::size_t end = points.end(y); i < end; i += stride) {
      const int x = points.columns[i];
      overlap.sfm[found] = points.sfm[i];
      overlap.sfm_variance[found] = points.sfm_variance[i];
      overlap.sensor[found] = points.sensor[i];
      overlap.sensor_variance[found] = sensor_variance(y, x);
      overlap.x[found] = static_cast<float>((x - camera.cx) / camera.fx);
      overlap.y[found] = ray_y;
      overlap.tile[found] = static_cast<std::uint8_t>(tile_row + x * Overlap::kTileColumns / width);
      found += points.sensor[i] <= farthest ? 1u : 0u;  // no branch: it could not be predicted
    }
  }
  resize(found, &overlap);
  overlap.pixels = stride * found;
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
