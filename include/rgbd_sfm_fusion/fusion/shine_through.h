// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Drops SfM depth where the frame shows no texture. The keyframe has depth at edges of its image only. A
/// point whose edge the frame does not show is hidden behind a surface that came before it. Where that
/// surface has no SfM depth of its own, as a dark screen, nothing else tells.
///
/// Where the sensor sees, it tells what is hidden. Depth stays there, and counts when errors are learned.
///
/// @param grey    of the frame
/// @param sensor  [m] of the same size
/// @param sfm     [m] as seen from the frame; of the same size
void dropShineThrough(const GreyImage& grey, const DepthImage& sensor, GaussianDepth& sfm);

}  // namespace rgbd_sfm_fusion
