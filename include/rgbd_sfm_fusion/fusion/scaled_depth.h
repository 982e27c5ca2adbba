// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// What takes SfM depth from tracker units to metres.
struct ScaleTerms {
  double alpha = 1.0;            ///< [m/unit]
  double sigma_alpha = 0.0;      ///< [m/unit]
  double variance_factor = 1.0;  ///< [1] real over stated variance of SfM depth
  double shared_sigma = 0.0;     ///< [1/m] of inverse depth, shared by a region: an error of the poses
  double stretch_sigma = 0.0;    ///< [1] of an error of inverse depth that grows from `stretch_middle` on
  double stretch_middle = 0.0;   ///< [1/m] inverse depth
};

/// SfM depth in metres: N(Z = αμ, f α²σ² + μ²σ_α² + Z⁴ (σ_shared² + σ_stretch² (1/Z - middle)²)), none where
/// σ/Z exceeds `max_relative_sigma`.
/// @param buffer  its images, where of the right size, are overwritten and returned; they may be those of
///                `sfm`
GaussianDepth scaled(const GaussianDepth& sfm, const ScaleTerms& scale, double max_relative_sigma,
                     GaussianDepth buffer = {});

}  // namespace rgbd_sfm_fusion
