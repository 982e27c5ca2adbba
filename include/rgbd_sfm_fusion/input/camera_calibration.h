// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"

namespace rgbd_sfm_fusion {

/// What sensor_msgs/CameraInfo says of a camera, field by field and under the same names.
struct CameraCalibration {
  int width = 0;                 ///< [px]
  int height = 0;                ///< [px]
  std::string distortion_model;  ///< plumb_bob, rational_polynomial or equidistant; may be empty if D is zero
  std::vector<double> D;
  std::array<double, 9> K{};   ///< camera matrix of the raw image, row by row [px]
  std::array<double, 9> R{};   ///< must be the identity, or all zero: not set
  std::array<double, 12> P{};  ///< camera matrix of the rectified image [px]; P[0] = 0: not set, K is used
};

/// @throws std::invalid_argument naming the field of camera_info that cannot be used, and what it should be
void validate(const CameraCalibration& calibration);

/// The camera whose images the package works on: P, or K where P is not set; of the raw image's size.
PinholeCamera rectifiedCamera(const CameraCalibration& calibration);

/// Whether a depth image can be taken for one registered to the colour image: the same size, and a camera
/// matrix (K) that differs by no more than 0.5 % (the centre: of width and height).
/// @return nothing if so; else which field differs, and the two values
std::optional<std::string> differenceOfDepthCamera(const CameraCalibration& colour,
                                                   const CameraCalibration& depth);

}  // namespace rgbd_sfm_fusion
