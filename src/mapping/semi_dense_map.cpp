// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/semi_dense_map.h"

#include <algorithm>
#include <cmath>

namespace rgbd_sfm_fusion {
namespace {

constexpr float kMaxSquaredDeviation = 9.0F;  // [σ²] of an observation from the estimate
constexpr int kMaxRejections = 4;
constexpr float kRejectionGrowth = 1.2F;                        // of the variance
constexpr float kMaxScatter = 16.0F, kUnmatchedScatter = 9.0F;  // [σ²] that one observation counts as
constexpr int kScatterPrior = 2, kScatterMemory = 16;  // [observations] that say 1; and that are remembered

}  // namespace

void SemiDenseMap::create(const cv::Size& size) {
  estimate.create(size);
  by_readout.create(size);
  observations.create(size);
  rejections.create(size);
  scatter.create(size);
}

void SemiDenseMap::clear() {
  estimate.clear();
  by_readout.setTo(0.0);
  observations.setTo(0);
  rejections.setTo(0);
  scatter.setTo(1.0);
}

void SemiDenseMap::clearPixel(int pixel) {
  estimate.mean[0][pixel] = 0.0F;
  estimate.variance[0][pixel] = std::numeric_limits<float>::infinity();
  by_readout[0][pixel] = 0.0F;
  observations[0][pixel] = 0;
  rejections[0][pixel] = 0;
  scatter[0][pixel] = 1.0F;
}

void SemiDenseMap::clearOutside(const cv::Rect& area) {
  for (int v = 0; v < observations.rows; ++v) {
    for (int u = 0; u < observations.cols; ++u) {
      if (observations(v, u) != 0 && !area.contains({u, v})) clearPixel(v * observations.cols + u);
    }
  }
}

void update(const std::vector<StereoObservation>& observations, SemiDenseMap& map) {
  float *means = map.estimate.mean[0], *variances = map.estimate.variance[0];
  std::uint8_t *counts = map.observations[0], *rejections = map.rejections[0];
  float *scatters = map.scatter[0], *by_readout = map.by_readout[0];
  for (const StereoObservation& observed : observations) {
    const int i = observed.pixel;
    if (counts[i] == 0) {
      if (!observed.matched) continue;
      means[i] = observed.inverse_depth;
      variances[i] = observed.variance;
      by_readout[i] = observed.by_readout;
      counts[i] = 1;
      rejections[i] = 0;
      scatters[i] = 1.0F;
      continue;
    }
    const float deviation = observed.inverse_depth - means[i];
    const float squared = deviation * deviation, expected = variances[i] + observed.variance;
    const float scatter = observed.matched ? std::min(squared / expected, kMaxScatter) : kUnmatchedScatter;
    scatters[i] += (scatter - scatters[i]) /
                   static_cast<float>(std::min<int>(counts[i] + kScatterPrior, kScatterMemory));
    if (!observed.matched || squared > kMaxSquaredDeviation * expected) {
      variances[i] *= kRejectionGrowth;
      if (++rejections[i] > kMaxRejections) map.clearPixel(i);
      continue;
    }
    const float gain = variances[i] / (variances[i] + observed.variance);
    means[i] += gain * deviation;
    variances[i] *= 1.0F - gain;
    by_readout[i] += gain * (observed.by_readout - by_readout[i]);
    if (means[i] <= 0.0F) {
      map.clearPixel(i);
      continue;
    }
    counts[i] = static_cast<std::uint8_t>(std::min(counts[i] + 1, 255));
    if (rejections[i] > 0) --rejections[i];
  }
}

void propagate(const SemiDenseMap& from, const cv::Mat_<float>& from_image, const InverseDepthWarp& warp,
               const Brightness& brightness, const cv::Mat_<float>& to_image, const MappingOptions& options,
               SemiDenseMap& to) {
  constexpr float kRelativeNoise =
      0.01F;  // of the inverse depth: the pixel's centre is not where the point fell
  constexpr int kMaxCarriedObservations = 8;
  to.clear();
  const auto gain = static_cast<float>(brightness.gain), offset = static_cast<float>(brightness.offset);
  const float max_difference = 6.0F * options.image_noise;
  for (int v = 0; v < from_image.rows; ++v) {
    for (int u = 0; u < from_image.cols; ++u) {
      if (from.observations(v, u) == 0) continue;
      const auto point = warp(u, v, from.estimate.mean(v, u));
      if (!point) continue;
      const int row = point->row, column = point->column;
      if (std::abs(to_image(row, column) - gain * from_image(v, u) - offset) > max_difference) continue;

      const float to_rho = point->inverse_depth, noise = kRelativeNoise * to_rho;
      const float to_variance =
          point->derivative * point->derivative * from.estimate.variance(v, u) + noise * noise;
      float &mean_there = to.estimate.mean(row, column), &variance_there = to.estimate.variance(row, column);
      if (mean_there > 0.0F) {
        const float deviation = to_rho - mean_there;
        const bool same_surface =
            deviation * deviation < kMaxSquaredDeviation * (to_variance + variance_there);
        if (same_surface ? to_variance >= variance_there : deviation < 0.0F) continue;
      }
      mean_there = to_rho;
      variance_there = to_variance;
      to.by_readout(row, column) = point->derivative * from.by_readout(v, u);
      to.observations(row, column) =
          static_cast<std::uint8_t>(std::min<int>(from.observations(v, u), kMaxCarriedObservations));
      to.rejections(row, column) = from.rejections(v, u);
      to.scatter(row, column) = from.scatter(v, u);
    }
  }
}

}  // namespace rgbd_sfm_fusion
