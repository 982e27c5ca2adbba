// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>

#include "rgbd_sfm_fusion/fusion/fusion_options.h"
#include "rgbd_sfm_fusion/fusion/sfm_points.h"

namespace rgbd_sfm_fusion {

/// The factor from tracker units to the sensor's metres. As a fit of one frame (fitScale()): Z = alpha *
/// Z_tracker, Eq. 9 and 10. As FusedFrame::scale: the same where sensor and SfM overlap, by the state, which
/// has an offset as well; pixels are turned into metres by the state (sfm_state.h).
struct ScaleEstimate {
  double alpha = std::numeric_limits<double>::quiet_NaN();  ///< [m/unit] NaN before the first fit
  double sigma = std::numeric_limits<double>::quiet_NaN();  ///< [m/unit] NaN before the first fit
  std::uint32_t inliers = 0;                                ///< [px] that this frame's fit rests on
  double residual =
      std::numeric_limits<double>::quiet_NaN();  ///< [1] spread of d/(αμ) over the inliers; NaN: no fit
  double spread = 1.0;  ///< [1] spread of the inliers over the spread that their variances
                        ///< promise; kWeightedRobust only
  bool refused = true;  ///< this frame says nothing of the scale: alpha is held, and sigma grows

  bool hasScale() const { return alpha > 0.0; }
};

/// The fit of a single frame; FusedFrame::scale is held where it is refused, and has b in it. It is `refused`
/// if there is too little to fit; then alpha and sigma are NaN.
///
/// `kWeightedRobust` looks for the α that as many of the ratios q = d/μ agree on as `min_inliers` asks for. q
/// is linear in SfM's inverse depth, whose errors are Gaussian, so these errors do not bias α. A weight that
/// depended on the pixel's own error would bias α: so a weight is made of the sensor's depth and the tile's
/// mean σ_ρ. Errors of neighbouring pixels are not independent, so `sigma` comes from a jackknife over image
/// tiles. It is used with the other estimators only: with this one, the state has the uncertainty
/// (sfm_state.h).
ScaleEstimate fitScale(const Overlap& overlap, const ScaleOptions& options);

}  // namespace rgbd_sfm_fusion
