// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/sensor/depth_noise.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "rgbd_sfm_fusion/multiversion.h"
#include "rgbd_sfm_fusion/option_check.h"
#include "rgbd_sfm_fusion/sensor/lateral_variance.h"
#include "rgbd_sfm_fusion/sensor/stray_depth.h"

namespace rgbd_sfm_fusion {
namespace {

/// Eq. 8 for a row.
RGBD_SFM_FUSION_MULTIVERSION
void axialVarianceRow(const float* depth, int width, float quadratic, float floor, float* variance) {
  for (int x = 0; x < width; ++x) {
    const float sigma = quadratic * depth[x] * depth[x];
    variance[x] = sigma * sigma + floor * floor;
  }
}

/// Drops depth that is not used, and adds the bias of far depth to the variance.
RGBD_SFM_FUSION_MULTIVERSION
void limitRangeRow(const float* depth, int width, const DepthNoiseModel noise, float farthest, float* mean,
                   float* variance) {
  for (int x = 0; x < width; ++x) {
    const bool used = (depth[x] >= noise.min_range) & (depth[x] <= farthest);
    mean[x] = used ? depth[x] : kNoDepth;
    const float raised = variance[x] + noise.farVariance(depth[x]);
    const float most = kMaxRelativeSigma * kMaxRelativeSigma * depth[x] * depth[x];
    variance[x] = used ? (raised < most ? raised : most) : kNoDepth;
  }
}

RGBD_SFM_FUSION_MULTIVERSION
void addFarBiasRow(const float* depth, int width, const DepthNoiseModel noise, float* variance) {
  for (int x = 0; x < width; ++x) {
    const float raised = variance[x] + noise.farVariance(depth[x]);
    variance[x] = depth[x] > 0.0f ? raised : kNoDepth;
  }
}

/// Depth whose bias alone exceeds the largest ratio is not used.
float farthestUsed(const DepthNoiseModel& noise) {
  if (noise.far_bias_sigma <= 0.0f) return noise.max_range;
  return std::max(kMaxRelativeSigma / noise.far_bias_sigma, noise.max_range);
}

}  // namespace

DepthNoiseModel DepthNoiseModel::astra() {
  DepthNoiseModel noise;
  noise.min_range = 0.6f;
  noise.max_range = 8.0f;
  return noise;
}

DepthNoiseModel DepthNoiseModel::preset(const std::string& name) {
  if (name == "kinect") return kinect();
  if (name == "xtion") return xtion();
  if (name == "astra") return astra();
  throw std::invalid_argument("depth noise preset = '" + name + "': must be 'kinect', 'xtion' or 'astra'");
}

Eigen::Vector2f DepthNoiseModel::sigmaXY(const PinholeCamera& camera, float x, float y, float depth) const {
  const Eigen::Vector3d ray = camera.backProject(static_cast<double>(x), static_cast<double>(y), 1.0);
  return ray.head<2>().cwiseAbs().cast<float>() * sigmaZ(depth);
}

float DepthNoiseModel::variance(float depth) const {
  if (!(depth >= min_range && depth <= farthestUsed(*this))) return kNoDepth;
  return sigmaZ(depth) * sigmaZ(depth) + floor * floor + farVariance(depth);
}

DepthNoiseModel DepthNoiseModel::withinRange() const {
  DepthNoiseModel noise = *this;
  noise.far_bias_sigma = 0.0f;
  return noise;
}

void validate(const DepthNoiseModel& noise) {
  requireInRange("noise_quadratic", noise.quadratic, 1e-6f, 0.1f);
  requireInRange("noise_floor", noise.floor, 0.0f, 0.1f);
  requireInRange("noise_lateral", noise.lateral_sigma, 0.0f, 10.0f);
  requireInRange("common_scale_sigma", noise.common_scale_sigma, 0.0f, 0.05f);
  requireInRange("common_offset_sigma", noise.common_offset_sigma, 0.0f, 0.05f);
  requireInRange("min_range", noise.min_range, 1e-3f, 10.0f);
  requireInRange("max_range", noise.max_range, std::max(noise.min_range, 0.1f), 100.0f);
  requireInRange("far_bias_sigma", noise.far_bias_sigma, 0.0f, 0.05f);
  requireInRange("saturated_depth", noise.saturated_depth, 0.0f, 100.0f);
}

GaussianDepth withNoise(const SortedDepth& depth, const DepthNoiseModel& noise, GaussianDepth buffer,
                        cv::Mat_<float>* surface_variance) {
  const DepthImage &confirmed = depth.confirmed, &credible = depth.credible;
  GaussianDepth result = std::move(buffer);
  result.mean.create(confirmed.size());
  result.variance.create(confirmed.size());
  if (surface_variance != nullptr) surface_variance->create(confirmed.size());
  LateralVariance lateral(noise.lateral_sigma, confirmed.cols);
  for (int y = 0; y < confirmed.rows; ++y) {
    axialVarianceRow(credible[y], credible.cols, noise.quadratic, noise.floor, result.variance[y]);
    // Steps to depth that is out of range count, too.
    lateral.addToRow(credible, y, result.variance[y],
                     surface_variance != nullptr ? (*surface_variance)[y] : nullptr);
    limitRangeRow(confirmed[y], confirmed.cols, noise, farthestUsed(noise), result.mean[y],
                  result.variance[y]);
    if (surface_variance != nullptr)
      addFarBiasRow(confirmed[y], confirmed.cols, noise, (*surface_variance)[y]);
  }
  return result;
}

GaussianDepth withNoise(const DepthImage& depth, const DepthNoiseModel& noise, GaussianDepth buffer,
                        cv::Mat_<float>* surface_variance) {
  return withNoise(SortedDepth{depth, depth}, noise, std::move(buffer), surface_variance);
}

}  // namespace rgbd_sfm_fusion
