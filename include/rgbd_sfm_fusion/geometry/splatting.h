// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/geometry/depth_warp.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Each point goes to the pixel whose centre is nearest. Of points of one surface, the most certain stays,
/// else the nearest.
/// @param source  without anything between its rows, as `target`
/// @param target  overwritten
void splatNearest(const GaussianDepth& source, const DepthWarp& warp, float sigmas_squared,
                  GaussianDepth* target);

/// Weighted mean of the nearest surface's points around each pixel that is the nearest one to a point. The
/// variance is the mean of their variances: neighbours' errors are taken as one error.
void splatBilinear(const GaussianDepth& source, const DepthWarp& warp, float sigmas_squared,
                   GaussianDepth* target);

}  // namespace rgbd_sfm_fusion
