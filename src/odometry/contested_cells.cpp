// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/contested_cells.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "rgbd_sfm_fusion/median.h"
#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr float kLargest = 0.2F;    // of inverse depth: a pixel's larger difference is cut off, as an outlier
constexpr double kSmallest = 0.02;  // smaller differences come from the sensor's scale and distortion
constexpr double kPoseError = 0.002;  // [depths of the scene]

/// Weighted sums over a square's pixels that have both depths, per lane.
struct DifferenceSums {
  std::array<float, kLanes> difference{}, inverse_depth{}, weight{};
};

/// The first pixel of a square in each of the four images, whose rows are `stride` apart.
struct Square {
  const float *sensor, *sensor_variance, *stereo, *stereo_variance;
  std::ptrdiff_t stride;
};

RGBD_SFM_FUSION_MULTIVERSION
DifferenceSums sumDifferences(const Square& square, std::ptrdiff_t width, std::ptrdiff_t height) {
  DifferenceSums sums;
  for (std::ptrdiff_t row = 0; row < height; ++row) {
    for (std::ptrdiff_t block = 0; block + kLanes <= width; block += kLanes) {
      const std::ptrdiff_t first = row * square.stride + block;
      const float *sensor = square.sensor + first, *sensor_variance = square.sensor_variance + first;
      const float *stereo = square.stereo + first, *stereo_variance = square.stereo_variance + first;
      // Most blocks have no stereo.
      float largest = 0.0F;
      for (std::size_t l = 0; l < kLanes; ++l) largest = stereo[l] > largest ? stereo[l] : largest;
      if (!(largest > 0.0F)) continue;
      for (std::size_t l = 0; l < kLanes; ++l) {
        const bool both = (sensor[l] > 0.0F) & (stereo[l] > 0.0F);
        const float weight = both ? 1.0F / (sensor_variance[l] + stereo_variance[l]) : 0.0F;
        const float limit = kLargest * stereo[l];
        sums.difference[l] += weight * std::min(std::max(sensor[l] - stereo[l], -limit), limit);
        sums.inverse_depth[l] += weight * stereo[l];
        sums.weight[l] += weight;
      }
    }
  }
  return sums;
}

float total(const std::array<float, kLanes>& lanes) {
  float sum = 0.0F;
  for (const float lane : lanes) sum += lane;
  return sum;
}

}  // namespace

const std::vector<cv::Rect>& ContestedCells::find(const InverseDepthImage& sensor,
                                                  const InverseDepthImage& stereo, double parallax,
                                                  const RowBands& bands) {
  contested_.clear();
  compare(sensor, stereo, bands);
  known_.clear();
  for (const double difference : differences_) {
    if (difference >= 0.0) known_.push_back(difference);
  }
  if (known_.empty()) return contested_;
  // More than squares usually differ: what all have in common is no sign of a mirror.
  const double limit = kSmallest + median(known_) + kPoseError / std::max(parallax, 1e-6);
  const cv::Rect image({0, 0}, sensor.mean.size());
  for (int row = 0; row < differences_.rows; ++row) {
    if (!bands.has(row)) continue;
    for (int column = 0; column < differences_.cols; ++column) {
      if (differences_(row, column) > limit)
        contested_.push_back(image & cv::Rect(column * kCell, row * kCell, kCell, kCell));
    }
  }
  return contested_;
}

void ContestedCells::compare(const InverseDepthImage& sensor, const InverseDepthImage& stereo,
                             const RowBands& bands) {
  const cv::Size size = stereo.mean.size(),
                 cells{(size.width + kCell - 1) / kCell, (size.height + kCell - 1) / kCell};
  if (differences_.size() != cells) differences_ = cv::Mat_<double>(cells, -1.0);
  for (int row = 0; row < cells.height; ++row) {
    if (!bands.has(row)) continue;
    for (int column = 0; column < cells.width; ++column) {
      const int top = row * kCell, left = column * kCell;
      const DifferenceSums sums =
          sumDifferences({sensor.mean[top] + left, sensor.variance[top] + left, stereo.mean[top] + left,
                          stereo.variance[top] + left, size.width},
                         std::min(kCell, size.width - left), std::min(kCell, size.height - top));
      const float weight = total(sums.weight);
      // Only what is beyond chance counts: a mean of few pixels may be off by as much as one of them.
      const float difference = std::abs(total(sums.difference)) - std::sqrt(kOneSurface * weight);
      differences_(row, column) =
          weight > 0.0F ? static_cast<double>(std::max(difference, 0.0F) / total(sums.inverse_depth)) : -1.0;
    }
  }
}

}  // namespace rgbd_sfm_fusion
