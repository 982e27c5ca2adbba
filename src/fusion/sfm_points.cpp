// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/sfm_points.h"

#include <initializer_list>

namespace rgbd_sfm_fusion {
namespace {

/// Appends the values of a row at these columns; NaN if there is no row.
void append(const std::vector<int>& columns, std::size_t count, const float* row, std::vector<float>& values) {
  const std::size_t begin = values.size();
  values.resize(begin + count, kNoDepth);
  if (row == nullptr) return;
  float* const to = values.data() + begin;
  for (std::size_t i = 0; i < count; ++i) to[i] = row[columns[i]];
}

}  // namespace

void SfmPoints::collect(const SensorDepth& of_sensor, const GaussianDepth& of_sfm) {
  const cv::Size size = of_sensor.depth.mean.size();
  rows_.assign(static_cast<std::size_t>(size.height) + 1, 0);
  columns.clear();
  for (std::vector<float>* values :
       {&sfm, &sfm_variance, &sensor, &sensor_variance, &surface_variance, &of_any_range}) {
    values->clear();
  }
  if (of_sfm.mean.empty()) return;
  if (row_.columns.size() < static_cast<std::size_t>(size.width)) row_ = RowPoints(size.width);
  for (int y = 0; y < size.height; ++y) {
    row_.gather(of_sfm.mean[y]);
    const std::size_t count = row_.count;
    columns.insert(columns.end(), row_.columns.begin(), row_.columns.begin() + static_cast<std::ptrdiff_t>(count));
    sfm.insert(sfm.end(), row_.depths.begin(), row_.depths.begin() + static_cast<std::ptrdiff_t>(count));
    append(row_.columns, count, of_sfm.variance[y], sfm_variance);
    append(row_.columns, count, of_sensor.depth.mean[y], sensor);
    append(row_.columns, count, of_sensor.depth.variance[y], sensor_variance);
    append(row_.columns, count, of_sensor.surfaceVariance()[y], surface_variance);
    append(row_.columns, count, of_sensor.of_any_range.empty() ? nullptr : of_sensor.of_any_range[y],
           of_any_range);
    rows_[static_cast<std::size_t>(y) + 1] = columns.size();
  }
}

}  // namespace rgbd_sfm_fusion
