// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <vector>

#include "rgbd_sfm_fusion/mapping/semi_dense_map.h"
#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kRadius = 2;
constexpr float kAgreement = 4.0F;  // [σ²] by which neighbours of one surface may differ
constexpr float kMinForGap = 4.0F;  // neighbours with an estimate around a gap that gets a prior
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Sums over the agreeing neighbours of a row's pixels.
struct RowSums {
  std::vector<float> weight, weighted_mean, agreeing, all_weight, all_weighted_mean, all_weighted_square,
      count;
  void reset(std::size_t width) {
    for (auto* sum : {&weight, &weighted_mean, &agreeing, &all_weight, &all_weighted_mean,
                      &all_weighted_square, &count}) {
      sum->assign(width, 0.0F);
    }
  }
};

RGBD_SFM_FUSION_MULTIVERSION
void addNeighbours(const float* mean, const float* variance, const float* other_mean,
                   const float* other_variance, int begin, int end, RowSums& sums) {
  float *weight = sums.weight.data(), *weighted_mean = sums.weighted_mean.data(),
        *agreeing = sums.agreeing.data();
  float *all_weight = sums.all_weight.data(), *all_weighted_mean = sums.all_weighted_mean.data();
  float *all_weighted_square = sums.all_weighted_square.data(), *count = sums.count.data();
  for (int u = begin; u < end; ++u) {
    const float w = 1.0F / other_variance[u];
    const float difference = mean[u] - other_mean[u];
    const bool exists = w > 0.0F;
    const bool agrees = exists & (difference * difference < kAgreement * (variance[u] + other_variance[u]));
    weight[u] += agrees ? w : 0.0F;
    weighted_mean[u] += agrees ? w * other_mean[u] : 0.0F;
    agreeing[u] += agrees ? 1.0F : 0.0F;
    all_weight[u] += w;
    all_weighted_mean[u] += w * other_mean[u];
    all_weighted_square[u] += w * other_mean[u] * other_mean[u];
    count[u] += exists ? 1.0F : 0.0F;
  }
}

RGBD_SFM_FUSION_MULTIVERSION
void finishRow(const float* mean, const float* variance, const RowSums& sums, int width, float* smoothed_mean,
               float* smoothed_variance, std::uint8_t* support) {
  const float *weight = sums.weight.data(), *weighted_mean = sums.weighted_mean.data();
  const float *agreeing = sums.agreeing.data(), *all_weight = sums.all_weight.data();
  const float* all_weighted_mean = sums.all_weighted_mean.data();
  const float *all_weighted_square = sums.all_weighted_square.data(), *count = sums.count.data();
  for (int u = 0; u < width; ++u) {
    const bool has_estimate = mean[u] > 0.0F;
    const bool is_gap = !has_estimate & (count[u] >= kMinForGap);
    const float gap_mean = all_weighted_mean[u] / all_weight[u];
    const float spread = std::max(all_weighted_square[u] / all_weight[u] - gap_mean * gap_mean, 0.0F);
    const float gap_variance = spread + count[u] / all_weight[u] + 0.01F * gap_mean * gap_mean;
    smoothed_mean[u] = has_estimate ? weighted_mean[u] / weight[u] : (is_gap ? gap_mean : 0.0F);
    smoothed_variance[u] = has_estimate ? variance[u] : (is_gap ? gap_variance : kInfinity);
    support[u] = has_estimate ? static_cast<std::uint8_t>(agreeing[u] - 1.0F) : std::uint8_t{0};
  }
}

}  // namespace

void regularise(const SemiDenseMap& map, InverseDepthImage& smoothed, cv::Mat_<std::uint8_t>& support) {
  const cv::Mat_<float>&mean = map.estimate.mean, &variance = map.estimate.variance;
  smoothed.create(mean.size());
  support.create(mean.size());
  RowSums sums;
  for (int v = 0; v < mean.rows; ++v) {
    sums.reset(static_cast<std::size_t>(mean.cols));
    for (int dv = std::max(-kRadius, -v); dv <= std::min(kRadius, mean.rows - 1 - v); ++dv) {
      for (int du = -kRadius; du <= kRadius; ++du) {
        addNeighbours(mean[v], variance[v], mean[v + dv] + du, variance[v + dv] + du, std::max(0, -du),
                      std::min(mean.cols, mean.cols - du), sums);
      }
    }
    finishRow(mean[v], variance[v], sums, mean.cols, smoothed.mean[v], smoothed.variance[v], support[v]);
  }
}

}  // namespace rgbd_sfm_fusion
