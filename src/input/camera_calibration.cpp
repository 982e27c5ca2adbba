// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/camera_calibration.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace rgbd_sfm_fusion {
namespace {

/// A rotation of the rectified camera by less than this [rad] moves nothing by a hundredth of a pixel.
constexpr double kRotationTolerance = 1e-6;
constexpr double kRelativeTolerance = 0.005;

[[noreturn]] void refuse(const std::string& field, const std::string& expected) {
  throw std::invalid_argument("camera_info: " + field + ", expected " + expected);
}

std::string text(double value) {
  std::ostringstream stream;
  stream << value;
  return stream.str();
}

template <class Numbers>
void requireFinite(const char* name, const Numbers& numbers) {
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (!std::isfinite(numbers[i]))
      refuse(std::string(name) + "[" + std::to_string(i) + "] is " + text(numbers[i]), "a finite number");
  }
}

template <class Numbers>
bool allZero(const Numbers& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double v) { return v == 0.0; });
}

void validateCameraMatrix(const char* name, double fx, double skew, double fy, const char* fy_index) {
  if (fx <= 0.0) refuse(std::string(name) + "[0] is " + text(fx), "the focal length in pixels, > 0");
  if (fy <= 0.0)
    refuse(std::string(name) + "[" + fy_index + "] is " + text(fy), "the focal length in pixels, > 0");
  if (skew != 0.0) refuse(std::string(name) + "[1] is " + text(skew), "0 (pixels without skew)");
}

void validateRotation(const std::array<double, 9>& R) {
  if (allZero(R)) return;
  for (std::size_t i = 0; i < R.size(); ++i) {
    const double identity = i % 4 == 0 ? 1.0 : 0.0;
    if (std::abs(R[i] - identity) > kRotationTolerance)
      refuse("R[" + std::to_string(i) + "] is " + text(R[i]),
             "the identity (a rotation would change what the depth image means)");
  }
}

void validateDistortion(const std::string& model, const std::vector<double>& D) {
  const auto requireCount = [&](std::initializer_list<std::size_t> counts, const char* expected) {
    if (std::find(counts.begin(), counts.end(), D.size()) == counts.end())
      refuse("D has " + std::to_string(D.size()) + " coefficients for " + model, expected);
  };
  if (model == "plumb_bob") {
    requireCount({0, 4, 5}, "5 (k1 k2 p1 p2 k3)");
  } else if (model == "rational_polynomial") {
    requireCount({0, 8, 12, 14}, "8 (k1 k2 p1 p2 k3 k4 k5 k6)");
  } else if (model == "equidistant") {
    requireCount({4}, "4 (k1 k2 k3 k4)");
  } else if (!model.empty() || !allZero(D)) {
    refuse("distortion_model is \"" + model + "\"", "plumb_bob, rational_polynomial or equidistant");
  }
}

}  // namespace

void validate(const CameraCalibration& calibration) {
  if (calibration.width <= 0) refuse("width is " + std::to_string(calibration.width), "the image's width");
  if (calibration.height <= 0)
    refuse("height is " + std::to_string(calibration.height), "the image's height");
  requireFinite("K", calibration.K);
  requireFinite("D", calibration.D);
  requireFinite("R", calibration.R);
  requireFinite("P", calibration.P);
  if (calibration.K[0] == 0.0)
    refuse("K[0] is 0: the camera is not calibrated", "the focal length in pixels");
  validateCameraMatrix("K", calibration.K[0], calibration.K[1], calibration.K[4], "4");
  if (calibration.P[0] != 0.0)
    validateCameraMatrix("P", calibration.P[0], calibration.P[1], calibration.P[5], "5");
  validateRotation(calibration.R);
  validateDistortion(calibration.distortion_model, calibration.D);
}

PinholeCamera rectifiedCamera(const CameraCalibration& calibration) {
  const auto& K = calibration.K;
  const auto& P = calibration.P;
  if (P[0] != 0.0) return {calibration.width, calibration.height, P[0], P[5], P[2], P[6]};
  return {calibration.width, calibration.height, K[0], K[4], K[2], K[5]};
}

std::optional<std::string> differenceOfDepthCamera(const CameraCalibration& colour,
                                                   const CameraCalibration& depth) {
  struct Field {
    const char* name;
    double colour, depth, tolerance;
  };
  const double width = colour.width, height = colour.height;
  const Field fields[] = {
      {"width", width, static_cast<double>(depth.width), 0.0},
      {"height", height, static_cast<double>(depth.height), 0.0},
      {"K[0]", colour.K[0], depth.K[0], kRelativeTolerance * colour.K[0]},
      {"K[4]", colour.K[4], depth.K[4], kRelativeTolerance * colour.K[4]},
      {"K[2]", colour.K[2], depth.K[2], kRelativeTolerance * width},
      {"K[5]", colour.K[5], depth.K[5], kRelativeTolerance * height},
  };
  for (const Field& field : fields) {
    if (std::abs(field.colour - field.depth) <= field.tolerance) continue;
    return std::string(field.name) + " is " + text(field.depth) + " in the depth image's camera_info and " +
           text(field.colour) + " in the colour image's";
  }
  return std::nullopt;
}

}  // namespace rgbd_sfm_fusion
