// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/semi_dense_map.h"

#include <algorithm>
#include <limits>

namespace rgbd_sfm_fusion {
namespace {

constexpr int kScatterPrior = 2;  // [observations] weight of the first value, 1

}  // namespace

void SemiDenseMap::create(const cv::Size& size) {
  estimate.create(size);
  by_readout = cv::Mat_<float>(size, 0.0F);
  by_pose = cv::Mat_<float>(size, 0.0F);
  observations.create(size);
  rejections.create(size);
  scatter = cv::Mat_<float>(size, 1.0F);
  clear();
}

void SemiDenseMap::clear() {
  estimate.clear();
  observations.setTo(0);
  rejections.setTo(0);
}

void SemiDenseMap::clearPixel(int pixel) {
  estimate.mean[0][pixel] = 0.0F;
  estimate.variance[0][pixel] = std::numeric_limits<float>::infinity();
  observations[0][pixel] = 0;
  rejections[0][pixel] = 0;
}

void update(const std::vector<StereoObservation>& observations, SemiDenseMap& map) {
  float *means = map.estimate.mean[0], *variances = map.estimate.variance[0];
  std::uint8_t *counts = map.observations[0], *rejections = map.rejections[0];
  float *scatters = map.scatter[0], *by_readout = map.by_readout[0], *by_pose = map.by_pose[0];
  for (const StereoObservation& observed : observations) {
    const int i = observed.pixel;
    if (counts[i] == 0) {
      if (!observed.matched) {
        rejections[i] = static_cast<std::uint8_t>(std::min(rejections[i] + 1, 255));
        continue;
      }
      means[i] = observed.inverse_depth;
      variances[i] = observed.variance;
      by_readout[i] = observed.by_readout;
      by_pose[i] = observed.by_pose;
      counts[i] = 1;
      rejections[i] = 0;
      scatters[i] = 1.0F;
      continue;
    }
    const float deviation = observed.inverse_depth - means[i];
    const float squared = deviation * deviation, expected = variances[i] + observed.variance;
    const float scatter = observed.matched ? std::min(squared / expected, kOneSurface) : kOneSurface;
    scatters[i] += (scatter - scatters[i]) / static_cast<float>(counts[i] + kScatterPrior);
    if (!observed.matched || squared > kOneSurface * expected) {
      if (rejections[i] == counts[i])
        map.clearPixel(i);
      else
        ++rejections[i];
      continue;
    }
    const float gain = variances[i] / (variances[i] + observed.variance);
    means[i] += gain * deviation;
    variances[i] *= 1.0F - gain;
    by_readout[i] += gain * (observed.by_readout - by_readout[i]);
    by_pose[i] += gain * (observed.by_pose - by_pose[i]);
    if (means[i] <= 0.0F) {
      map.clearPixel(i);
      continue;
    }
    counts[i] = static_cast<std::uint8_t>(std::min(counts[i] + 1, 255));
    if (rejections[i] > 0) --rejections[i];
  }
}

}  // namespace rgbd_sfm_fusion
