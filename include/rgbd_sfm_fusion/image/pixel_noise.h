// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// [grey levels] Standard deviation of a pixel's noise, from a single image: what a difference of two
/// Laplacians leaves, which is 0 on planes and on straight edges along rows or columns (Immerkær, Fast Noise
/// Variance Estimation, 1996). The tenth of the pixels that differ least tells it, as texture is elsewhere.
/// Where texture is that fine everywhere, the result is too large; where compression has taken the noise of
/// neighbours, too small.
/// @param seen  part of the image to look at; 0 if it is too small
double pixelNoise(const GreyImage& grey, const cv::Rect& seen);

}  // namespace rgbd_sfm_fusion
