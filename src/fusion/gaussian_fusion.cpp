// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/gaussian_fusion.h"

#include <cmath>
#include <limits>
#include <vector>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr int kSensor = static_cast<int>(Provenance::kSensor);
constexpr int kSfm = static_cast<int>(Provenance::kSfm);
constexpr int kFused = static_cast<int>(Provenance::kFused);
static_assert(kFused == (kSensor | kSfm), "fused is both");

/// A smaller overlap says nothing about the frame as a whole.
constexpr std::uint64_t kLeastOverlap = 200;  // [px]

RGBD_SFM_FUSION_MULTIVERSION
void scaleRow(const float* mean, const float* variance, int width, float alpha, float mean_factor,
              float variance_factor, float max_relative_variance, float* scaled_mean,
              float* scaled_variance) {
  for (int x = 0; x < width; ++x) {
    const float z = alpha * mean[x];
    const float v = variance_factor * variance[x] + mean_factor * mean[x] * mean[x];
    const bool usable = (z > 0.0f) & (v > 0.0f) & (v <= max_relative_variance * z * z);
    scaled_mean[x] = usable ? z : kNone;
    scaled_variance[x] = usable ? v : kNone;
  }
}

/// Eq. 13 and 14. Depths that disagree are left to the sensor.
RGBD_SFM_FUSION_MULTIVERSION
void fuseRow(const float* sensor_mean, const float* sensor_variance, const float* sfm_mean,
             const float* sfm_variance, int width, float max_chi_squared, float common_variance, float* mean,
             float* variance, std::uint8_t* provenance, std::uint8_t* disagreement) {
  for (int x = 0; x < width; ++x) {
    const float d = sensor_mean[x], vd = sensor_variance[x], m = sfm_mean[x], vm = sfm_variance[x];
    const bool has_sensor = d > 0.0f, has_sfm = m > 0.0f;  // false for NaN
    const float sum = vd + vm, difference = m - d;
    const bool agree = difference * difference <= max_chi_squared * sum;
    const bool fused = has_sensor & has_sfm & agree;
    const float gain = vd / sum;
    const float product = gain * vm;  // not above either, but for rounding
    const float least = vd < vm ? vd : vm;
    const float z = fused ? d + gain * difference : (has_sensor ? d : m);
    const float v = fused ? (product < least ? product : least) : (has_sensor ? vd : vm);
    mean[x] = z;
    variance[x] = v + common_variance * z * z;
    const int source = (has_sensor ? kSensor : 0) | (has_sfm & (fused | !has_sensor) ? kSfm : 0);
    provenance[x] = static_cast<std::uint8_t>(source);
    disagreement[x] = static_cast<std::uint8_t>(has_sensor & has_sfm & !agree ? 1 : 0);
  }
}

struct RowCounts {
  int of_source[4] = {0, 0, 0, 0};
  int disagreeing = 0;
};

RGBD_SFM_FUSION_MULTIVERSION
RowCounts countRow(const std::uint8_t* provenance, const std::uint8_t* disagreement, int width) {
  int sensor = 0, sfm = 0, fused = 0, disagreeing = 0;
  for (int x = 0; x < width; ++x) {
    sensor += provenance[x] == kSensor ? 1 : 0;
    sfm += provenance[x] == kSfm ? 1 : 0;
    fused += provenance[x] == kFused ? 1 : 0;
    disagreeing += disagreement[x] != 0 ? 1 : 0;
  }
  return {{width - sensor - sfm - fused, sensor, sfm, fused}, disagreeing};
}

/// At a hole or a step of the sensor's image, or at the image's border.
bool isAtBorder(const DepthImage& sensor, int x, int y) {
  if (x == 0 || y == 0 || x + 1 == sensor.cols || y + 1 == sensor.rows) return true;
  const float z = sensor(y, x), limit = kStepRatio * z;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (!(std::abs(sensor(y + dy, x + dx) - z) <= limit)) return true;
    }
  }
  return false;
}

/// Gives SfM those of a row's disagreeing pixels where the sensor is at its border.
void settleRow(const GaussianDepth& sensor, const GaussianDepth& sfm, int y, float common_variance,
               GaussianFusion* result) {
  for (int x = 0; x < sensor.mean.cols; ++x) {
    if (result->disagreement(y, x) == 0 || !isAtBorder(sensor.mean, x, y)) continue;
    const float z = sfm.mean(y, x);
    result->depth.mean(y, x) = z;
    result->depth.variance(y, x) = sfm.variance(y, x) + common_variance * z * z;
    result->provenance(y, x) = static_cast<std::uint8_t>(Provenance::kSfm);
    result->disagreement(y, x) = static_cast<std::uint8_t>(Disagreement::kSfmKept);
  }
}

}  // namespace

GaussianDepth scaled(const GaussianDepth& sfm, const ScaleTerms& scale, double max_relative_sigma) {
  GaussianDepth result{DepthImage(sfm.mean.size()), cv::Mat_<float>(sfm.mean.size())};
  const auto variance_factor = static_cast<float>(scale.variance_factor * scale.alpha * scale.alpha);
  const auto mean_factor = static_cast<float>(scale.sigma_alpha * scale.sigma_alpha);
  const auto limit = static_cast<float>(max_relative_sigma * max_relative_sigma);
  for (int y = 0; y < sfm.mean.rows; ++y) {
    scaleRow(sfm.mean[y], sfm.variance[y], sfm.mean.cols, static_cast<float>(scale.alpha), mean_factor,
             variance_factor, limit, result.mean[y], result.variance[y]);
  }
  return result;
}

GaussianFusion fuse(const GaussianDepth& sensor, const GaussianDepth& sfm, double common_scale_sigma,
                    const GaussianFusionOptions& options) {
  const cv::Size size = sensor.mean.size();
  GaussianFusion result{{DepthImage(size), cv::Mat_<float>(size)},
                        cv::Mat_<std::uint8_t>(size),
                        cv::Mat_<std::uint8_t>(size),
                        {},
                        0,
                        false};
  const float max_chi_squared = options.test_agreement ? static_cast<float>(options.max_chi_squared)
                                                       : std::numeric_limits<float>::infinity();
  const auto common_variance = static_cast<float>(common_scale_sigma * common_scale_sigma);
  const std::vector<float> none(static_cast<std::size_t>(size.width), kNone);
  for (int y = 0; y < size.height; ++y) {
    const float* sfm_mean = sfm.mean.empty() ? none.data() : sfm.mean[y];
    const float* sfm_variance = sfm.mean.empty() ? none.data() : sfm.variance[y];
    fuseRow(sensor.mean[y], sensor.variance[y], sfm_mean, sfm_variance, size.width, max_chi_squared,
            common_variance, result.depth.mean[y], result.depth.variance[y], result.provenance[y],
            result.disagreement[y]);
    RowCounts row = countRow(result.provenance[y], result.disagreement[y], size.width);
    if (row.disagreeing > 0) {
      settleRow(sensor, sfm, y, common_variance, &result);
      row = countRow(result.provenance[y], result.disagreement[y], size.width);
    }
    result.counts += ProvenanceCounts{static_cast<std::uint64_t>(row.of_source[kSensor]),
                                      static_cast<std::uint64_t>(row.of_source[kSfm]),
                                      static_cast<std::uint64_t>(row.of_source[kFused])};
    result.disagreeing += static_cast<std::uint64_t>(row.disagreeing);
  }

  const std::uint64_t overlap = result.counts.fused + result.disagreeing;
  const double share = static_cast<double>(result.disagreeing) / static_cast<double>(overlap);
  if (overlap < kLeastOverlap || share <= options.max_disagreement) return result;
  GaussianFusion sensor_only = fuse(sensor, {}, common_scale_sigma, options);
  sensor_only.disagreement.setTo(static_cast<double>(Disagreement::kSensorKept), result.disagreement != 0);
  sensor_only.disagreeing = result.disagreeing;
  sensor_only.sfm_rejected = true;
  return sensor_only;
}

}  // namespace rgbd_sfm_fusion
