// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/sfm_points.h"

#include <algorithm>
#include <array>
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

/// Copies the values of rows at these columns. All of them at once: one row after the other would wait for
/// memory as often as there are rows.
template <std::size_t Count>
void take(const int* columns, std::size_t count, const std::array<const float*, Count>& rows,
          const std::array<float*, Count>& values) {
  for (std::size_t i = 0; i < count; ++i) {
    const int column = columns[i];
    for (std::size_t k = 0; k < Count; ++k) values[k][i] = rows[k][column];
  }
}

RGBD_SFM_FUSION_MULTIVERSION
void markMissing(const float* depth, int count, std::uint8_t* __restrict marks) {
  for (int i = 0; i < count; ++i) marks[i] = depth[i] > 0.0f ? 0 : 1;
}

}  // namespace

void SfmPoints::collect(const GaussianDepth& depth, const SensorDepth& with) {
  const DepthImage& of_sensor = with.depth.mean;
  rows_.assign(static_cast<std::size_t>(of_sensor.rows) + 1, 0);
  unseen_rows_.assign(rows_.size(), 0);
  if (of_sensor.cols != width_ || columns.size() < of_sensor.total() + kLanes) grow(of_sensor.size());
  std::size_t found = 0, unseen = 0;
  for (int y = 0; y < of_sensor.rows; ++y) {
    const std::size_t count = row_.find(depth.mean[y], columns.data() + found);
    const auto rowOf = [&](const cv::Mat_<float>& image) { return image.empty() ? none_.data() : image[y]; };
    const auto at = [&](std::vector<float>& values) { return values.data() + found; };
    take<6>(
        columns.data() + found, count,
        {depth.mean[y], rowOf(depth.variance), of_sensor[y], rowOf(with.depth.variance),
         rowOf(with.surfaceVariance()), rowOf(with.of_any_range)},
        {at(sfm), at(sfm_variance), at(sensor), at(sensor_variance), at(surface_variance), at(of_any_range)});
    markMissing(sensor.data() + found, static_cast<int>(count), marks_.data());
    std::fill_n(marks_.data() + count, kLanes, std::uint8_t{0});
    unseen += static_cast<std::size_t>(
        findMarks(marks_.data(), 0, static_cast<int>(count), unseen_.data() + unseen));
    found += count;
    rows_[static_cast<std::size_t>(y) + 1] = found;
    unseen_rows_[static_cast<std::size_t>(y) + 1] = unseen;
  }
}

void SfmPoints::clear() {
  std::fill(rows_.begin(), rows_.end(), 0U);
  std::fill(unseen_rows_.begin(), unseen_rows_.end(), 0U);
}

void SfmPoints::dropAndWrite(const cv::Mat_<std::uint8_t>& marked, GaussianDepth* depth) {
  for (int y = 0; y < depth->mean.rows; ++y) {
    float *const mean = depth->mean[y], *const variance = depth->variance[y];
    const std::uint8_t* const marks = marked[y];
    for (std::size_t i = begin(y), last = end(y); i < last; ++i) {
      const int x = columns[i];
      if (marks[x] != 0) sfm[i] = sfm_variance[i] = kNoDepth;
      mean[x] = sfm[i];
      variance[x] = sfm_variance[i];
    }
  }
}

void SfmPoints::grow(const cv::Size& size) {
  width_ = 0;  // until there is memory for all
  row_ = RowPoints(size.width);
  none_.assign(static_cast<std::size_t>(size.width), kNoDepth);
  const auto pixels = static_cast<std::size_t>(size.area() + kLanes);
  columns.resize(pixels);
  unseen_.resize(pixels);
  marks_.resize(static_cast<std::size_t>(size.width + kLanes));
  for (std::vector<float>* values :
       {&sfm, &sfm_variance, &sensor, &sensor_variance, &surface_variance, &of_any_range}) {
    values->resize(pixels);
  }
  width_ = size.width;
}

double Overlap::adjacency(std::size_t i, std::size_t j) {
  constexpr auto kColumns = static_cast<std::size_t>(kTileColumns);
  const auto gap = [](std::size_t a, std::size_t b) { return a > b ? a - b : b - a; };
  const std::size_t columns = gap(i % kColumns, j % kColumns), rows = gap(i / kColumns, j / kColumns);
  return columns > 1 || rows > 1 ? 0.0 : (columns == 0 ? 1.0 : 0.5) * (rows == 0 ? 1.0 : 0.5);
}

Overlap collectOverlap(const SfmPoints& points, const SensorDepth& sensor, const PinholeCamera& camera,
                       std::size_t max_samples) {
  Overlap overlap;
  const std::size_t stride = max_samples == 0 ? 1 : points.size() / max_samples + 1;
  resize(points.size() / stride + 1, &overlap);
  const int width = sensor.depth.mean.cols, height = sensor.depth.mean.rows;
  std::size_t found = 0, i = 0;
  for (int y = 0; y < height; ++y) {
    const int tile_row = y * Overlap::kTileRows / height * Overlap::kTileColumns;
    const auto ray_y = static_cast<float>((y - camera.cy) / camera.fy);
    for (const std::size_t end = points.end(y); i < end; i += stride) {
      const int x = points.columns[i];
      overlap.sfm[found] = points.sfm[i];
      overlap.sfm_variance[found] = points.sfm_variance[i];
      overlap.sensor[found] = points.sensor[i];
      overlap.sensor_variance[found] = points.sensor_variance[i];
      overlap.x[found] = static_cast<float>((x - camera.cx) / camera.fx);
      overlap.y[found] = ray_y;
      overlap.tile[found] = static_cast<std::uint8_t>(tile_row + x * Overlap::kTileColumns / width);
      const bool is_used = points.sensor[i] <= sensor.noise.max_range;
      found += is_used ? 1u : 0u;
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
