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
  std::string distortion_model;  ///< plumb_bob, rational_polynomial or equidistant; any where D is zero
  std::vector<double> D;         ///< more coefficients than the model has may follow, if they are zero
  std::array<double, 9> K{};     ///< camera matrix of the raw image, row by row [px]
  std::array<double, 9>
      R{};  ///< not used: depth is registered to the camera as it is, not as R would turn it
  std::array<double, 12> P{};  ///< camera matrix of the rectified image [px]; P[0] = 0: not set, K is used.
                               ///< Its fourth column is about another camera, and not used

  bool operator==(const CameraCalibration& other) const;
};

/// What of the calibration is set, and not used: R and P's fourth column. Empty where nothing is.
std::string unusedParts(const CameraCalibration& calibration);

/// What camera_info says of how the published image was cut out of the camera's: first the region, then
/// pixels are joined.
struct ImageSection {
  int x = 0, y = 0;           ///< [px] of the region
  int width = 0, height = 0;  ///< [px]; 0: all
  int binning_x = 1, binning_y = 1;
};

/// The calibration of the published image. A pixel's coordinates are those of its centre, which for joined
/// pixels is between theirs.
/// @throws std::invalid_argument where the region is not within the image
CameraCalibration ofSection(const CameraCalibration& full, const ImageSection& section);

/// The calibration of images that were rectified already: P without distortion.
CameraCalibration ofRectifiedImages(const CameraCalibration& raw);

/// D as OpenCV takes it for the model: without what is more than the model has. Empty where all of it is
/// zero, and the model is not equidistant.
std::vector<double> usedCoefficients(const CameraCalibration& calibration);

/// @throws std::invalid_argument naming the field of camera_info that cannot be used, and what it should be
void validate(const CameraCalibration& calibration);

/// The camera whose images the package works on: P, or K where P is not set; of the raw image's size.
PinholeCamera rectifiedCamera(const CameraCalibration& calibration);

/// Whether the camera matrix (K) of depth of colour's size differs by more than 0.5 % (the centre: of width
/// and height). Depth of another size is judged by DepthResampling.
/// @return nothing if not; else which field differs, and the two values
std::optional<std::string> differenceOfDepthCamera(const CameraCalibration& colour,
                                                   const CameraCalibration& depth);

}  // namespace rgbd_sfm_fusion
