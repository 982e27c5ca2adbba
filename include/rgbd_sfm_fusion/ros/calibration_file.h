// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "rgbd_sfm_fusion/input/camera_calibration.h"

namespace rgbd_sfm_fusion {

/// A calibration as camera_info_manager and camera_calibration write it (YAML, or INI).
/// @param place  a path, or a URL as `file:///path` or `package://name/path`
/// @throws std::runtime_error naming the file, what is wrong with it, and what was expected
CameraCalibration readCalibrationFile(const std::string& place);

}  // namespace rgbd_sfm_fusion
