// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Removes SfM depth of what is seen in a mirror or through a pane, where an obstacle is nearer than what it
/// shows. Structured light does not come back from glass: it leaves a hole in the sensor's depth whose rim
/// lies all around in one plane. A doorway has a hole too, but its floor leaves that plane; a dark picture
/// has such a rim, but SfM sees it in the plane, and not behind it. Where the image's edge cuts off a part
/// of the rim, nothing is removed.
///
/// @param sensor  [m] H x W, NaN = none
/// @param sfm     [m] H x W, NaN = none; changed where the sensor has nothing
void removeReflections(const DepthImage& sensor, GaussianDepth& sfm);

}  // namespace rgbd_sfm_fusion
