// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/tracking/direct_alignment.h"

namespace rgbd_sfm_fusion {

/// [grey levels] Huber's estimate of a scale: the noise for which the bounded squares have the same mean as
/// with Gaussian errors.
/// @param noise  that the equations' residuals are weighted by
/// @param huber  [σ] threshold of the Huber norm
double noiseOf(const NormalEquations& equations, double noise, double huber);

/// Covariance of the keyframe-side step. It has two parts: the scatter of independent pixels, and that of the
/// strips of the image (addScatter()). Depth residuals count as independent.
/// @param equations  at the solution, with an H that is positive definite
Matrix6 stepCovariance(const NormalEquations& equations);

/// Derivative of the keyframe-side step by an error of the motion during the readout, in the keyframe's axes.
/// Alignment takes such an error for a step, as each strip is off by its share of the error.
/// @param equations  at the solution, with an H that is positive definite
Matrix6 stepByReadout(const NormalEquations& equations);

}  // namespace rgbd_sfm_fusion
