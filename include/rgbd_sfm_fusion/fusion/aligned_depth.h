// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/fusion/sfm_calibration.h"
#include "rgbd_sfm_fusion/fusion/sfm_state.h"
#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// SfM depth in metres: N(Z = 1/ρ, Z⁴ (f σ_ρ²/α² + J P Jᵀ + σ_shared² + σ_stretch² (ρ - middle)²)). SfmState
/// defines ρ and J P Jᵀ. A pixel has no depth where σ/Z exceeds `max_relative_sigma`.
/// @param sfm              tracker units
/// @param buffer  images of the right size are overwritten and returned; they may be the images of `sfm`
GaussianDepth aligned(const GaussianDepth& sfm, const SfmState& state, const SfmErrors& errors,
                      const PinholeCamera& camera, double max_relative_sigma, GaussianDepth buffer = {});

}  // namespace rgbd_sfm_fusion
