// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Drops SfM depth at the rims of the sensor's holes: where the sensor has nothing, but something in the
/// square of `width` pixels to each side. Holes begin at depth steps, where SfM's depth is as often that of
/// the one side as of the other: against exact truth, a fifth of it is more than 5 sigma off there, and no
/// variance tells which.
///
/// @param sensor  [m] H x W, NaN = none
/// @param width   [px] up to 100; 0 drops nothing
/// @param sfm     H x W, NaN = none
void dropAtRims(const DepthImage& sensor, int width, GaussianDepth& sfm);

}  // namespace rgbd_sfm_fusion
