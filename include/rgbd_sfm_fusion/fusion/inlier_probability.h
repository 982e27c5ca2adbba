// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/fusion/gaussian_fusion.h"

namespace rgbd_sfm_fusion {

/// What speaks for and against an SfM depth that no sensor depth can contradict: what is around it.
struct Evidence {
  int agreeing = 0;      ///< of the 24 pixels around, those with a depth of the same surface
  float farther = 0.0F;  ///< [m] depth of a surface behind, beyond a gap beside the pixel's own; 0 = none
};

/// Probability that an SfM depth is right. Wrong matches have few neighbours that agree; and both sides of an
/// occluding contour get the depth of the surface in front, of which the far side's is wrong. Fitted to the
/// shares of SfM-only pixels more than 5 σ from exact truth (five rendered rooms): 20, 10, 5, 3, 2 % with 0,
/// 1, 2, 3, 4 pixels that agree, and 5 % beside a surface behind.
double inlierProbability(const Evidence& evidence);

/// Drops SfM-only depths that are less probably right than `min_probability`, and makes the variance of
/// others that of a mixture: with the surface behind, and more of it where few neighbours agree, since what
/// is published has been smoothed over those; and a floor of 1 % of Z, since nothing checks them. Depths of
/// more than `max_relative_sigma` are dropped, too.
void judgeSfmOnly(double min_probability, double max_relative_sigma, GaussianFusion& fusion);

}  // namespace rgbd_sfm_fusion
