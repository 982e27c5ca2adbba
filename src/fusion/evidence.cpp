// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/evidence.h"

#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kCell = Evidence::kCell;

/// The four sums over pixels. Those of a cell stand side by side.
enum { kFor, kAgainst, kWeight, kWeighted, kSums };
using Sums = cv::Mat_<cv::Vec<float, kSums>>;

/// Points [begin, end) of a row, filled up to full blocks by what follows.
struct PointsOfRow {
  const float *sensor, *sensor_variance, *surface_variance, *sfm, *sfm_variance;
  int padded;
};

/// Votes for and against; weight p of the difference of inverse depth (SfM less sensor); p times this
/// difference.
RGBD_SFM_FUSION_MULTIVERSION
void comparePoints(const PointsOfRow row, const DepthNoiseModel noise_model, float max_chi_squared,
                   float* __restrict agrees, float* __restrict against, float* __restrict weight,
                   float* __restrict weighted) {
  for (int i = 0; i < row.padded; ++i) {
    const float d = row.sensor[i], vd = row.sensor_variance[i], v = row.surface_variance[i], m = row.sfm[i],
                vm = row.sfm_variance[i];
    const float squared_difference = (m - d) * (m - d);  // NaN unless the pixel has both depths
    const bool one = squared_difference <= max_chi_squared * (v + vm);
    const bool two = squared_difference > max_chi_squared * (vd + vm);
    agrees[i] = one ? 1.0f : 0.0f;
    against[i] = two ? 1.0f : 0.0f;
    const float squared = d * d, sigma = noise_model.quadratic * squared;
    const float model = sigma * sigma + noise_model.floor * noise_model.floor;
    const float noise = model < v ? model : v;
    const float inverse = 1.0f / (v * v * m);  // one division for both weights
    const float scaled = noise * squared * d * inverse;
    const bool counts = one & (d <= noise_model.max_range);
    weight[i] = counts ? scaled * d * m : 0.0f;
    weighted[i] = counts ? scaled * (d - m) : 0.0f;
  }
}

/// Adds each point to the cell that it is in.
void addToCells(const int* columns, std::size_t count, const std::array<std::vector<float>, kSums>& found,
                float* __restrict cells) {
  const float *agrees = found[kFor].data(), *against = found[kAgainst].data();
  const float *weight = found[kWeight].data(), *weighted = found[kWeighted].data();
  for (std::size_t i = 0; i < count; ++i) {
    float* const cell = cells + kSums * (static_cast<unsigned>(columns[i]) / kCell);
    cell[kFor] += agrees[i];
    cell[kAgainst] += against[i];
    cell[kWeight] += weight[i];
    cell[kWeighted] += weighted[i];
  }
}

/// Sums over the cells around.
Sums around(const Sums& sums) {
  static const cv::Matx13f weights(0.5f, 1.0f, 0.5f);
  Sums result;
  cv::sepFilter2D(sums, result, -1, weights, weights, {-1, -1}, 0.0, cv::BORDER_CONSTANT);
  return result;
}

}  // namespace

Evidence evidenceAround(const SensorDepth& sensor, const SfmPoints& sfm, float max_chi_squared) {
  const cv::Size size = sensor.depth.mean.size();
  const cv::Size cells((size.width + kCell - 1) / kCell, (size.height + kCell - 1) / kCell);
  Sums sums(cells, Sums::value_type::all(0.0f));
  std::array<std::vector<float>, kSums> found;
  for (std::vector<float>& values : found) values.resize(static_cast<std::size_t>(paddedToLanes(size.width)));
  for (int y = 0; y < size.height; ++y) {
    const std::size_t begin = sfm.begin(y), count = sfm.end(y) - begin;
    const auto from = [&](const std::vector<float>& values) { return values.data() + begin; };
    comparePoints({from(sfm.sensor), from(sfm.sensor_variance), from(sfm.surface_variance), from(sfm.sfm),
                   from(sfm.sfm_variance), paddedToLanes(static_cast<int>(count))},
                  sensor.noise, max_chi_squared, found[kFor].data(), found[kAgainst].data(),
                  found[kWeight].data(), found[kWeighted].data());
    addToCells(sfm.columns.data() + begin, count, found, sums[y / kCell]->val);
  }
  const Sums all = around(sums);
  Evidence evidence{cv::Mat_<float>(cells), cv::Mat_<float>(cells), cv::Mat_<float>(cells)};
  for (int row = 0; row < cells.height; ++row) {
    for (int cell = 0; cell < cells.width; ++cell) {
      const float* const of = all(row, cell).val;
      // The two added votes are a uniform prior.
      const float ratio = (of[kFor] + 1.0f) / (of[kAgainst] + 1.0f);
      evidence.odds(row, cell) = ratio == 1.0f ? 0.0f : std::log(ratio);
      const float p = of[kWeight];
      evidence.difference(row, cell) = p > 0.0f ? of[kWeighted] / p : 0.0f;
      evidence.noise_variance(row, cell) = static_cast<float>(Overlap::kPixelsOfOneError) / p;
    }
  }
  return evidence;
}

}  // namespace rgbd_sfm_fusion
