// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/common_errors.h"

#include <opencv2/imgproc.hpp>
#include <vector>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kCell = CommonErrors::kCell;
constexpr int kFused = static_cast<int>(Provenance::kFused);
constexpr float kPixelsOfOneError = 9.0f;  // of the sensor

struct Row {
  const float *sensor, *sensor_variance, *sfm;
  const std::uint8_t* provenance;
};

/// Weights p of the differences of inverse depth, SfM less sensor, and p times these.
RGBD_SFM_FUSION_MULTIVERSION
void compareRow(const Row row, int width, const DepthNoiseModel noise_model, float* __restrict weight,
                float* __restrict weighted) {
  for (int x = 0; x < width; ++x) {
    const float d = row.sensor[x], v = row.sensor_variance[x], m = row.sfm[x];
    const float squared = d * d, sigma = noise_model.quadratic * squared;
    const float model = sigma * sigma + noise_model.floor * noise_model.floor;
    const float noise = model < v ? model : v;
    const float inverse = 1.0f / (v * v * m);  // one division for both
    const float scaled = noise * squared * d * inverse;
    const bool averaged = (row.provenance[x] == kFused) & (d <= noise_model.max_range);
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

  /// The values of a row, to be filled in.
  float* values() { return values_.data(); }
  void addRow(int y) { addToCells(values_.data(), sums_.cols, sums_[y / kCell]); }

  cv::Mat_<float> around() const {
    static const cv::Matx13f weights(0.5f, 1.0f, 0.5f);
    cv::Mat_<float> result;
    cv::sepFilter2D(sums_, result, -1, weights, weights, {-1, -1}, 0.0, cv::BORDER_CONSTANT);
    return result;
  }

 private:
  std::vector<float> values_;  // none beyond the image's width
  cv::Mat_<float> sums_;
};

}  // namespace

CommonErrors commonErrors(const SensorDepth& sensor, const DepthImage& sfm,
                          const cv::Mat_<std::uint8_t>& provenance) {
  CellSum weight(provenance.size()), weighted(provenance.size());
  for (int y = 0; y < provenance.rows; ++y) {
    compareRow({sensor.depth.mean[y], sensor.surfaceVariance()[y], sfm[y], provenance[y]}, provenance.cols,
               sensor.noise, weight.values(), weighted.values());
    weight.addRow(y);
    weighted.addRow(y);
  }
  const cv::Mat_<float> weights = weight.around(), sums = weighted.around();
  CommonErrors errors{cv::Mat_<float>(weights.size()), cv::Mat_<float>(weights.size())};
  for (int row = 0; row < weights.rows; ++row) {
    for (int cell = 0; cell < weights.cols; ++cell) {
      const float p = weights(row, cell);
      errors.difference(row, cell) = p > 0.0f ? sums(row, cell) / p : 0.0f;
      errors.noise_variance(row, cell) = kPixelsOfOneError / p;
    }
  }
  return errors;
}

}  // namespace rgbd_sfm_fusion
