// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Removes SfM depth of what is seen in a mirror or through a pane, where an obstacle is nearer than what it
/// shows. Structured light does not come back from glass: it leaves a hole in the sensor's depth whose rim
/// lies all around in one plane, and SfM sees things behind that plane which the sensor should have seen.
/// A doorway to what is beyond the sensor's range has such a hole too, but nothing in range is missing there;
/// of a dark picture SfM's depth lies in the plane, and not behind it. Where the image's edge cuts off a part
/// of the rim, nothing is removed.
///
/// @param sensor     [m] H x W, NaN = none
/// @param max_range  [m] of the sensor
/// @param sfm        [m] H x W, NaN = none; changed where the sensor has nothing
void removeReflections(const DepthImage& sensor, float max_range, GaussianDepth& sfm);

}  // namespace rgbd_sfm_fusion
