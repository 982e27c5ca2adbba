// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/tracking/direct_alignment.h"

namespace rgbd_sfm_fusion {

/// [grey levels] Huber's estimate of a scale: the noise for which the bounded squares have the same mean as
/// with Gaussian errors. Points count as in AlignmentResult::share_good.
/// @param noise  that the equations' residuals are weighted by
/// @param huber  [σ] threshold of the Huber norm
double noiseOf(const NormalEquations& equations, double noise, double huber);

/// What brightness and depth together say of the keyframe-side step.
struct StepEstimate {
  NormalEquations::Vector step;
  Matrix6 covariance;  ///< of the pose's part
  /// Derivative of the pose's part by an error of the motion during the readout, in the keyframe's axes.
  /// Alignment takes such an error for a step, as each strip is off by its share of the error.
  Matrix6 by_readout;
  double alike;               ///< so many points share their errors, and count as one
  Matrix6 depth_information;  ///< as in AlignmentResult
  Vector6 depth_pull;         ///< as in AlignmentResult
};

/// Generalised least squares: brightness and depth each count by the covariance that their residuals have.
/// That has two parts: the scatter of independent pixels, and that of the strips of the image (addScatter()).
/// Counted as independent, tens of thousands of points would outvote depth, while they share errors of the
/// keyframe's depth, of blur and of moving things; most of all about a turn, which looks like a move
/// sideways.
/// @param equations  near the solution, with an H that is positive definite
StepEstimate estimateStep(const NormalEquations& equations);

}  // namespace rgbd_sfm_fusion
