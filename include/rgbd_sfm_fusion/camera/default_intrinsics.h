// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"

namespace rgbd_sfm_fusion {

/// A camera that nobody has calibrated: square pixels, and a principal point at the centre of its 4:3
/// image. Devices' 5:4 modes have the 4:3 image's columns and further rows below it.
/// @param width,height    [px]
/// @param horizontal_fov  [rad]; where the driver tells nothing sensible, an Astra's 60 degrees
PinholeCamera defaultIntrinsics(int width, int height, double horizontal_fov);

}  // namespace rgbd_sfm_fusion
