// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"

namespace rgbd_sfm_fusion {

/// The fields of sensor_msgs/CameraInfo that describe a camera, under the same names.
struct CameraCalibration {
  int width = 0;                 ///< [px]
  int height = 0;                ///< [px]
  std::string distortion_model;  ///< plumb_bob, rational_polynomial or equidistant; any name if D is zero
  std::vector<double> D;         ///< more coefficients than the model has may follow, if they are zero
  std::array<double, 9> K{};     ///< camera matrix of the raw image, row by row [px]
  std::array<double, 9>
      R{};  ///< not used: depth is registered to the camera as it is, not as R would turn it
  std::array<double, 12> P{};  ///< camera matrix of the rectified image [px]; P[0] = 0: not set, K is used.
                               ///< The fourth column is about another camera, and is not used

  bool operator==(const CameraCalibration& other) const;
};

/// The fields of the calibration that are set but not used: R, and P's fourth column. Empty if there are
/// none.
std::string unusedParts(const CameraCalibration& calibration);

/// How the published image was made from the camera's image: first a region was cut out, then pixels were
/// joined. camera_info says both.
struct ImageSection {
  int x = 0, y = 0;           ///< [px] of the region
  int width = 0, height = 0;  ///< [px]; 0: all
  int binning_x = 1, binning_y = 1;
};

/// The calibration of the published image. Coordinates refer to pixel centres. The centre of a joined pixel
/// is the middle between the centres of the pixels that were joined.
/// @throws std::invalid_argument where the region is not within the image
CameraCalibration ofSection(const CameraCalibration& full, const ImageSection& section);

/// The calibration of images that were rectified already: P without distortion.
CameraCalibration ofRectifiedImages(const CameraCalibration& raw);

/// D as OpenCV takes it for the model, without surplus coefficients. Empty where all coefficients are zero
/// and the model is not equidistant.
std::vector<double> usedCoefficients(const CameraCalibration& calibration);

/// @throws std::invalid_argument naming the field of camera_info that cannot be used, and what it should be
void validate(const CameraCalibration& calibration);

/// The camera of the images that the package works on: P, or K if P is not set. The camera has the raw
/// image's size.
PinholeCamera rectifiedCamera(const CameraCalibration& calibration);

/// Compares the depth camera's K with the colour camera's K. The limit is 0.5 %; for the centre it is 0.5 %
/// of width and height. Both images have the same size; DepthResampling judges depth of another size.
/// @return nothing if no field differs by more; else the field that differs, and both values
std::optional<std::string> differenceOfDepthCamera(const CameraCalibration& colour,
                                                   const CameraCalibration& depth);

}  // namespace rgbd_sfm_fusion
