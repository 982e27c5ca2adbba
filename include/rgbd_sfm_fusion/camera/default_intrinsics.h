// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"

namespace rgbd_sfm_fusion {

/// Intrinsics of a camera that nobody has calibrated: square pixels, and the principal point at the centre of
/// its 4:3 image. Devices' 5:4 modes have the columns of the 4:3 image and more rows below it.
/// @param width,height    [px]
/// @param horizontal_fov  [rad]; an Astra's 60 degrees are used if the driver's value makes no sense
PinholeCamera defaultIntrinsics(int width, int height, double horizontal_fov);

}  // namespace rgbd_sfm_fusion
