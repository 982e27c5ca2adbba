// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/common_errors.h"

#include <opencv2/imgproc.hpp>
#include <vector>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kCell = CommonErrors::kCell;
constexpr float kPixelsOfOneError = 9.0f;  // of the sensor
constexpr int kFused = static_cast<int>(Provenance::kFused);

/// The sensor's precision of inverse depth, and that times the difference of inverse depths, SfM less sensor.
RGBD_SFM_FUSION_MULTIVERSION
void compareRow(const float* sensor, const float* variance, const float* sfm, const std::uint8_t* provenance,
                int width, float* __restrict precision, float* __restrict difference) {
  for (int x = 0; x < width; ++x) {
    const float d = sensor[x], m = sfm[x];
    const float scaled = d * d * d / (m * variance[x]);  // one division for both
    const bool averaged = provenance[x] == kFused;
    precision[x] = averaged ? scaled * d * m : 0.0f;
    difference[x] = averaged ? scaled * (d - m) : 0.0f;
  }
}

RGBD_SFM_FUSION_MULTIVERSION
void addToCells(const float* values, int cells, float* __restrict sums) {
  for (int cell = 0; cell < cells; ++cell) {
    const float* v = values + kCell * cell;
    sums[cell] += (v[0] + v[1]) + (v[2] + v[3]);
  }
}

/// Over the cells around each, nearer ones counting more.
void sumAround(cv::Mat_<float>& cells) {
  static const cv::Matx13f weights(0.5f, 1.0f, 0.5f);
  cv::sepFilter2D(cells, cells, -1, weights, weights, {-1, -1}, 0.0, cv::BORDER_CONSTANT);
}

}  // namespace

CommonErrors commonErrors(const GaussianDepth& sensor, const DepthImage& sfm,
                          const cv::Mat_<std::uint8_t>& provenance) {
  const int cells = (sfm.cols + kCell - 1) / kCell;
  cv::Mat_<float> precisions((sfm.rows + kCell - 1) / kCell, cells);
  precisions.setTo(0.0);
  cv::Mat_<float> differences = precisions.clone();
  std::vector<float> precision(static_cast<std::size_t>(kCell * cells)), difference(precision.size());
  for (int y = 0; y < sfm.rows; ++y) {
    compareRow(sensor.mean[y], sensor.variance[y], sfm[y], provenance[y], sfm.cols, precision.data(),
               difference.data());
    addToCells(precision.data(), cells, precisions[y / kCell]);
    addToCells(difference.data(), cells, differences[y / kCell]);
  }
  sumAround(precisions);
  sumAround(differences);
  for (int row = 0; row < precisions.rows; ++row) {
    for (int cell = 0; cell < cells; ++cell) {
      float &p = precisions(row, cell), &r = differences(row, cell);
      r = p > 0.0f ? r / p : 0.0f;
      p = kPixelsOfOneError / p;  // infinite where nothing is known
    }
  }
  return {differences, precisions};
}

}  // namespace rgbd_sfm_fusion
