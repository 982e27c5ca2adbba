// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Drops SfM depth at the rims of the sensor's holes, where it may belong to either side: of pixels that have
/// no sensor depth, but sensor depth near. Against exact truth, a fifth of this SfM depth is more than 5
/// sigma off, and no variance tells which.
/// @param sensor  [m], [m^2] H x W, NaN = none
/// @param width   [px] from sensor depth within which a pixel is near to it; 0: none is
/// @param sfm     H x W, NaN = none
void dropAtRims(const GaussianDepth& sensor, int width, GaussianDepth& sfm);

}  // namespace rgbd_sfm_fusion
