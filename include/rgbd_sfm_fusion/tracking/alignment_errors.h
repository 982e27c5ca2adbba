// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/tracking/direct_alignment.h"

namespace rgbd_sfm_fusion {

/// [grey levels] Huber's estimate of a scale: the noise with which bounded squares are on average what they
/// are where errors are Gaussian.
/// @param noise  that the equations' residuals are weighted by
/// @param huber  [σ] threshold of their norm
double noiseOf(const NormalEquations& equations, double noise, double huber);

/// Covariance of the keyframe-side step. Residuals of neighbours are alike: they share the errors of their
/// depths, of the shutter and of what moved. So what counts is how far the gradients of whole strips of the
/// image scatter, adjacent ones together (White 1980; Newey and West 1987), besides what independent
/// pixels would do. Depth residuals count as independent.
/// @param equations  at the solution, with an H that is positive definite
Matrix6 stepCovariance(const NormalEquations& equations);

/// The keyframe-side step that an error of the motion during the readout, in the keyframe's axes, is taken
/// for: each strip is then off by its share of it.
/// @param equations  at the solution, with an H that is positive definite
Matrix6 stepByReadout(const NormalEquations& equations);

}  // namespace rgbd_sfm_fusion
