// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "rgbd_sfm_fusion/fusion/sensor_depth.h"
#include "rgbd_sfm_fusion/geometry/row_points.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// The pixels of a frame that have SfM depth, in the order of the image, with the depths that are compared
/// there. Most pixels have none, so that what concerns SfM's depth is quicker on the list than on images.
class SfmPoints {
 public:
  /// Takes the place of the points before. Memory is allocated for the first frame only.
  /// @param sfm  [m]; empty = no SfM depth in this frame
  void collect(const SensorDepth& sensor, const GaussianDepth& sfm);

  /// The points of row `y` are those from begin(y) up to, and without, end(y).
  std::size_t begin(int y) const { return rows_[static_cast<std::size_t>(y)]; }
  std::size_t end(int y) const { return begin(y + 1); }
  std::size_t size() const { return rows_.empty() ? 0 : rows_.back(); }

  /// Vectors are longer than the list.
  std::vector<int> columns;
  std::vector<float> sfm, sfm_variance;                          ///< [m], [m²]
  std::vector<float> sensor, sensor_variance, surface_variance;  ///< [m], [m²] see SensorDepth; NaN = none
  std::vector<float> of_any_range;                               ///< [m] see SensorDepth; NaN = not known

 private:
  void grow(const cv::Size& size);

  RowPoints row_{0};
  std::vector<std::size_t> rows_;
};

}  // namespace rgbd_sfm_fusion
