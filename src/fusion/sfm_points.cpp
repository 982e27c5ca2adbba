// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/sfm_points.h"

#include <algorithm>
#include <initializer_list>

namespace rgbd_sfm_fusion {
namespace {

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
  if (columns.size() < static_cast<std::size_t>(size.area())) grow(size);
  std::size_t found = 0;
  for (int y = 0; y < size.height; ++y) {
    row_.gather(of_sfm.mean[y]);
    const std::size_t count = row_.count;
    std::copy_n(row_.columns.begin(), count, columns.data() + found);
    std::copy_n(row_.depths.begin(), count, sfm.data() + found);
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
  row_ = RowPoints(size.width);
  const auto pixels = static_cast<std::size_t>(size.area());
  columns.resize(pixels);
  for (std::vector<float>* values :
       {&sfm, &sfm_variance, &sensor, &sensor_variance, &surface_variance, &of_any_range}) {
    values->resize(pixels);
  }
}

}  // namespace rgbd_sfm_fusion
