// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/gaussian_fusion.h"

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "rgbd_sfm_fusion/multiversion.h"
#include "rgbd_sfm_fusion/sensor/lateral_variance.h"

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

/// The two depths of each pixel of a row; 0 or NaN = none.
struct Inputs {
  const float *sensor_mean, *sensor_variance, *sfm_mean, *sfm_variance;
};

/// Eq. 13 and 14. Depths that disagree are left to the sensor.
RGBD_SFM_FUSION_MULTIVERSION
void fuseRow(const Inputs in, int width, float max_chi_squared, float common_variance, float* __restrict mean,
             float* __restrict variance) {
  for (int x = 0; x < width; ++x) {
    const float d = in.sensor_mean[x], vd = in.sensor_variance[x];
    const float m = in.sfm_mean[x], vm = in.sfm_variance[x];
    const float sum = vd + vm, difference = m - d;
    const float gain = vd / sum;
    const float product = gain * vm;  // not above either, but for rounding
    const float least = vd < vm ? vd : vm;
    // Comparisons with NaN are false, which settles where there is one depth only.
    const bool agree = difference * difference <= max_chi_squared * sum;
    const bool has_sensor = d > 0.0f;
    const float z = agree ? d + gain * difference : (has_sensor ? d : m);
    const float v = agree ? (product < least ? product : least) : (has_sensor ? vd : vm);
    mean[x] = z;
    variance[x] = v + common_variance * z * z;
  }
}

/// Where each depth of fuseRow() is from.
RGBD_SFM_FUSION_MULTIVERSION
void classifyRow(const Inputs in, int width, float max_chi_squared, std::uint8_t* __restrict provenance,
                 std::uint8_t* __restrict disagreement) {
  for (int x = 0; x < width; ++x) {
    const float d = in.sensor_mean[x], m = in.sfm_mean[x], difference = m - d;
    const float sum = in.sensor_variance[x] + in.sfm_variance[x];
    const int sensor = d > 0.0f ? kSensor : 0;
    const int sfm = m > 0.0f ? kSfm : 0;
    const int disagrees = difference * difference > max_chi_squared * sum ? 1 : 0;
    provenance[x] = static_cast<std::uint8_t>((sensor | sfm) - disagrees * kSfm);
    disagreement[x] = static_cast<std::uint8_t>(disagrees);
  }
}

struct RowCounts {
  int with_sensor = 0, with_sfm = 0, fused = 0, disagreeing = 0;
};

RGBD_SFM_FUSION_MULTIVERSION
void countRow(const std::uint8_t* provenance, const std::uint8_t* disagreement, int width,
              RowCounts* __restrict counts) {
  int with_sensor = 0, with_sfm = 0, fused = 0, disagreeing = 0;
  for (int x = 0; x < width; ++x) {
    const int source = provenance[x];
    with_sensor += source & 1;
    with_sfm += source >> 1;
    fused += source & (source >> 1);
    disagreeing += disagreement[x] != 0 ? 1 : 0;
  }
  *counts = {with_sensor, with_sfm, fused, disagreeing};
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
  const std::uint8_t* disagreement = result->disagreement[y];
  for (int x = 0; x < sensor.mean.cols; ++x) {
    if (disagreement[x] == 0 || !isAtBorder(sensor.mean, x, y)) continue;
    const float z = sfm.mean(y, x);
    result->depth.mean(y, x) = z;
    result->depth.variance(y, x) = sfm.variance(y, x) + common_variance * z * z;
    result->provenance(y, x) = static_cast<std::uint8_t>(Provenance::kSfm);
    result->disagreement(y, x) = static_cast<std::uint8_t>(Disagreement::kSfmKept);
  }
}

}  // namespace

GaussianDepth scaled(const GaussianDepth& sfm, const ScaleTerms& scale, double max_relative_sigma,
                     GaussianDepth buffer) {
  GaussianDepth result = std::move(buffer);
  result.mean.create(sfm.mean.size());
  result.variance.create(sfm.mean.size());
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
                    const GaussianFusionOptions& options, GaussianFusion buffer) {
  const cv::Size size = sensor.mean.size();
  GaussianFusion result{
      std::move(buffer.depth), std::move(buffer.provenance), std::move(buffer.disagreement), {}, 0, false};
  result.depth.mean.create(size);
  result.depth.variance.create(size);
  result.provenance.create(size);
  result.disagreement.create(size);
  constexpr float kNoLimit = std::numeric_limits<float>::max();
  const float max_chi_squared =
      options.test_agreement ? static_cast<float>(options.max_chi_squared) : kNoLimit;
  const auto common_variance = static_cast<float>(common_scale_sigma * common_scale_sigma);
  const std::vector<float> none(static_cast<std::size_t>(size.width), kNone);
  for (int y = 0; y < size.height; ++y) {
    const float* sfm_mean = sfm.mean.empty() ? none.data() : sfm.mean[y];
    const float* sfm_variance = sfm.mean.empty() ? none.data() : sfm.variance[y];
    const Inputs in{sensor.mean[y], sensor.variance[y], sfm_mean, sfm_variance};
    fuseRow(in, size.width, max_chi_squared, common_variance, result.depth.mean[y], result.depth.variance[y]);
    classifyRow(in, size.width, max_chi_squared, result.provenance[y], result.disagreement[y]);
    RowCounts row;
    countRow(result.provenance[y], result.disagreement[y], size.width, &row);
    if (row.disagreeing > 0) {
      settleRow(sensor, sfm, y, common_variance, &result);
      countRow(result.provenance[y], result.disagreement[y], size.width, &row);
    }
    result.counts += ProvenanceCounts{static_cast<std::uint64_t>(row.with_sensor - row.fused),
                                      static_cast<std::uint64_t>(row.with_sfm - row.fused),
                                      static_cast<std::uint64_t>(row.fused)};
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
