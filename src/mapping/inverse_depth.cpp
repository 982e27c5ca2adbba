// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/inverse_depth.h"

#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

RGBD_SFM_FUSION_MULTIVERSION
void invert(const float* __restrict mean, const float* __restrict variance, int count,
            float* __restrict depth, float* __restrict depth_variance) {
  for (int i = 0; i < count; ++i) {
    const bool exists = mean[i] > 0.0F;
    const float inverse = 1.0F / mean[i], squared = inverse * inverse;
    depth[i] = exists ? inverse : std::numeric_limits<float>::quiet_NaN();
    depth_variance[i] = exists ? variance[i] * squared * squared : std::numeric_limits<float>::quiet_NaN();
  }
}

}  // namespace

GaussianDepth toDepth(const InverseDepthImage& inverse_depth, ImagePool& pool) {
  const cv::Size size = inverse_depth.mean.size();
  GaussianDepth depth{pool.take<float>(size), pool.take<float>(size)};
  invert(inverse_depth.mean[0], inverse_depth.variance[0], static_cast<int>(inverse_depth.mean.total()),
         depth.mean[0], depth.variance[0]);
  return depth;
}

}  // namespace rgbd_sfm_fusion
