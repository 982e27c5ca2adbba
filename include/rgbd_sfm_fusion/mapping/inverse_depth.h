// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <opencv2/core.hpp>

#include "rgbd_sfm_fusion/image_pool.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Per-pixel Gaussian inverse depth N(ρ, σ²_ρ) [1 / tracker unit]. A pixel without one has variance
/// infinity (weight zero) and inverse depth 0, so that weighted sums need no branch.
struct InverseDepthImage {
  cv::Mat_<float> mean, variance;

  void create(const cv::Size& size) {
    mean.create(size);
    variance.create(size);
  }
  void clear() {
    mean.setTo(0.0F);
    variance.setTo(std::numeric_limits<float>::infinity());
  }
};

/// The same as depth, to first order in σ_ρ/ρ (DESIGN 3.2): μ = 1/ρ, σ² = σ²_ρ/ρ⁴.
/// @param pool  the result's images are taken from it
GaussianDepth toDepth(const InverseDepthImage& inverse_depth, ImagePool& pool);

}  // namespace rgbd_sfm_fusion
