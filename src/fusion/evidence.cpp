// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/evidence.h"

#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kCell = Evidence::kCell;
constexpr float kPixelsOfOneError = 9.0f;  // pixels of the sensor that err alike
constexpr float kPrior = 1.0f;             // [px] for, and as many against, before any pixel is counted
constexpr float kEnd = 0.25f;              // [px] against, for a pixel where the sensor's surface ends

/// The four sums over pixels.
enum { kFor, kAgainst, kWeight, kWeighted, kSums };

struct Row {
  const float *sensor, *sensor_variance, *surface_variance, *sfm, *sfm_variance;
};

/// Votes for and against; weight p of the difference of inverse depth (SfM less sensor); p times this
/// difference.
RGBD_SFM_FUSION_MULTIVERSION
void compareRow(const Row row, int width, const DepthNoiseModel noise_model, float max_chi_squared,
                float* __restrict agrees, float* __restrict against, float* __restrict weight,
                float* __restrict weighted) {
  for (int x = 0; x < width; ++x) {
    const float d = row.sensor[x], vd = row.sensor_variance[x], v = row.surface_variance[x], m = row.sfm[x],
                vm = row.sfm_variance[x];
    const float chi_squared = (m - d) * (m - d);  // NaN unless the pixel has both depths
    const bool one = chi_squared <= max_chi_squared * (v + vm);
    const bool two = chi_squared > max_chi_squared * (vd + vm);
    const float end = vd <= v ? 0.0f : kEnd;  // a step raises the variance; holes have none
    agrees[x] = one ? 1.0f : 0.0f;
    against[x] = (two ? 1.0f : 0.0f) + end;
    const float squared = d * d, sigma = noise_model.quadratic * squared;
    const float model = sigma * sigma + noise_model.floor * noise_model.floor;
    const float noise = model < v ? model : v;
    const float inverse = 1.0f / (v * v * m);  // one division for both weights
    const float scaled = noise * squared * d * inverse;
    const bool averaged = one & (d <= noise_model.max_range);
    weight[x] = averaged ? scaled * d * m : 0.0f;
    weighted[x] = averaged ? scaled * (d - m) : 0.0f;
  }
}

RGBD_SFM_FUSION_MULTIVERSION
void addToCells(const float* values, int cells, float* __restrict sums) {
  for (int cell = 0; cell < cells; ++cell) {
    const float* v = values + kCell * cell;
    sums[cell] += (v[0] + v[1]) + (v[2] + v[3]);
  }
}

/// A sum over the pixels of each cell, and then over the cells around.
class CellSum {
 public:
  explicit CellSum(const cv::Size& image)
      : values_(static_cast<std::size_t>((image.width + kCell - 1) / kCell * kCell)),
        sums_((image.height + kCell - 1) / kCell, (image.width + kCell - 1) / kCell) {
    sums_.setTo(0.0);
  }

  /// The values of a row. The caller fills them in.
  float* values() { return values_.data(); }
  void addRow(int y) { addToCells(values_.data(), sums_.cols, sums_[y / kCell]); }

  cv::Mat_<float> around() const {
    static const cv::Matx13f weights(0.5f, 1.0f, 0.5f);
    cv::Mat_<float> result;
    cv::sepFilter2D(sums_, result, -1, weights, weights, {-1, -1}, 0.0, cv::BORDER_CONSTANT);
    return result;
  }

 private:
  std::vector<float> values_;  // 0 beyond the image's width
  cv::Mat_<float> sums_;
};

}  // namespace

float Evidence::probability(int y, int x) const {
  return 1.0f / (1.0f + std::exp(-odds(y / kCell, x / kCell)));
}

Evidence evidenceAround(const SensorDepth& sensor, const GaussianDepth& sfm, float max_chi_squared) {
  const cv::Size size = sfm.mean.size();
  std::array<CellSum, kSums> sums{CellSum(size), CellSum(size), CellSum(size), CellSum(size)};
  for (int y = 0; y < size.height; ++y) {
    compareRow({sensor.depth.mean[y], sensor.depth.variance[y], sensor.surfaceVariance()[y], sfm.mean[y],
                sfm.variance[y]},
               size.width, sensor.noise, max_chi_squared, sums[kFor].values(), sums[kAgainst].values(),
               sums[kWeight].values(), sums[kWeighted].values());
    for (CellSum& sum : sums) sum.addRow(y);
  }
  const cv::Mat_<float> agree = sums[kFor].around(), against = sums[kAgainst].around();
  const cv::Mat_<float> weights = sums[kWeight].around(), weighted = sums[kWeighted].around();
  Evidence evidence{cv::Mat_<float>(agree.size()), cv::Mat_<float>(agree.size()),
                    cv::Mat_<float>(agree.size())};
  for (int row = 0; row < agree.rows; ++row) {
    for (int cell = 0; cell < agree.cols; ++cell) {
      evidence.odds(row, cell) = std::log((agree(row, cell) + kPrior) / (against(row, cell) + kPrior));
      const float p = weights(row, cell);
      evidence.difference(row, cell) = p > 0.0f ? weighted(row, cell) / p : 0.0f;
      evidence.noise_variance(row, cell) = kPixelsOfOneError / p;
    }
  }
  return evidence;
}

}  // namespace rgbd_sfm_fusion
