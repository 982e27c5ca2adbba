// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Seconds with all nine decimals; empty for kNoStamp.
std::string formatStamp(Stamp stamp);

/// Fixed decimals, in any locale; `nan` for NaN.
std::string formatNumber(double value, int decimals);

/// `tx ty tz qx qy qz qw`, with `separator` between them and qw >= 0.
std::string formatPose(const SE3& T, char separator);

}  // namespace rgbd_sfm_fusion
