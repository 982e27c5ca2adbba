// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "rgbd_sfm_fusion/fusion/fusion_options.h"
#include "rgbd_sfm_fusion/fusion/provenance.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Two depth images made into one. All images have the same size.
struct GaussianFusion {
  GaussianDepth depth;
  cv::Mat_<std::uint8_t> provenance;    ///< values of Provenance
  cv::Mat_<std::uint8_t> disagreement;  ///< values of Disagreement
  ProvenanceCounts counts;
  std::uint64_t disagreeing = 0;  ///< [px]
  bool sfm_rejected = false;      ///< too much of the overlap disagrees: pose or scale is wrong
};

/// What takes SfM depth from tracker units to metres.
struct ScaleTerms {
  double alpha = 1.0;            ///< [m/unit]
  double sigma_alpha = 0.0;      ///< [m/unit]
  double variance_factor = 1.0;  ///< [1] real over stated variance of SfM depth
};

/// SfM depth in metres: N(αμ, f α²σ² + μ²σ_α²), none where σ/Z exceeds `max_relative_sigma`.
GaussianDepth scaled(const GaussianDepth& sfm, const ScaleTerms& scale, double max_relative_sigma);

/// Product of Gaussians per pixel (paper, Eq. 13 and 14); where there is one depth only, that one.
///
/// Depths that differ by more than chance allows (`max_chi_squared`) are not averaged, since one of them is
/// wrong. The sensor's is kept: its errors are small and dense, while SfM's rare errors are gross (a wrong
/// match). The exception is the border of the sensor's own holes and steps, where its pattern is cut off
/// and SfM, which lives on image edges, is at home: there SfM's is kept.
///
/// @param sensor              [m]; NaN = none
/// @param sfm                 [m]; empty = no SfM depth in this frame
/// @param common_scale_sigma  [1] scale error that both share: added to the variance after fusion
GaussianFusion fuse(const GaussianDepth& sensor, const GaussianDepth& sfm, double common_scale_sigma,
                    const GaussianFusionOptions& options);

}  // namespace rgbd_sfm_fusion
