// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/camera_calibration.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "rgbd_sfm_fusion/input/image_view.h"
#include "rgbd_sfm_fusion/tools/number_text.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kRelativeTolerance = 0.005;

// No camera exceeds these limits. A broken message may.
constexpr double kShortestFocalLength = 0.05, kLongestFocalLength = 100.0;  // [image widths]
constexpr double kFarthestCentre = 10.0;                                    // [image widths] from the corner
constexpr double kLargestCoefficient = 1e4;                                 // of distortion

[[noreturn]] void refuse(const std::string& field, const std::string& expected) {
  throw std::invalid_argument("camera_info: " + field + ", expected " + expected);
}

template <class Numbers>
void requireFinite(const char* name, const Numbers& numbers) {
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (!std::isfinite(numbers[i]))
      refuse(std::string(name) + "[" + std::to_string(i) + "] is " + numberText(numbers[i]),
             "a finite number");
  }
}

template <class Numbers>
bool allZero(const Numbers& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double v) { return v == 0.0; });
}

/// The indices of a camera matrix's values in K or in P.
struct MatrixLayout {
  const char* name;
  std::size_t fx, skew, cx, fy, cy;
};

constexpr MatrixLayout kLayoutOfK{"K", 0, 1, 2, 4, 5};
constexpr MatrixLayout kLayoutOfP{"P", 0, 1, 2, 5, 6};

template <class Matrix>
void validateCameraMatrix(const MatrixLayout& layout, const Matrix& matrix, int width) {
  const auto requireWithin = [&](std::size_t index, double low, double high, const char* what) {
    const double value = matrix[index];
    if (value >= low * width && value <= high * width) return;
    refuse(std::string(layout.name) + "[" + std::to_string(index) + "] is " + numberText(value),
           std::string(what) + " in pixels, " + numberText(low * width) + " to " + numberText(high * width) +
               " for images of this width");
  };
  requireWithin(layout.fx, kShortestFocalLength, kLongestFocalLength, "the focal length");
  requireWithin(layout.fy, kShortestFocalLength, kLongestFocalLength, "the focal length");
  requireWithin(layout.cx, -kFarthestCentre, kFarthestCentre, "the image's centre");
  requireWithin(layout.cy, -kFarthestCentre, kFarthestCentre, "the image's centre");
  const double skew = matrix[layout.skew];
  if (skew != 0.0) refuse(std::string(layout.name) + "[1] is " + numberText(skew), "0 (pixels without skew)");
}

/// A distortion model, and how many coefficients OpenCV takes for it.
struct DistortionModel {
  const char* name;
  std::vector<std::size_t> counts;  ///< ascending
  const char* expected;
};

const DistortionModel* findModel(const std::string& name) {
  static const DistortionModel models[] = {
      {"plumb_bob", {4, 5}, "5 (k1 k2 p1 p2 k3)"},
      {"rational_polynomial", {4, 5, 8, 12, 14}, "8 (k1 k2 p1 p2 k3 k4 k5 k6)"},
      {"equidistant", {4}, "4 (k1 k2 k3 k4)"},
  };
  for (const DistortionModel& model : models) {
    if (name == model.name) return &model;
  }
  return nullptr;
}

/// The number of coefficients up to the last one that is not zero.
std::size_t lengthWithoutZeros(const std::vector<double>& D) {
  std::size_t length = D.size();
  while (length > 0 && D[length - 1] == 0.0) --length;
  return length;
}

void validateDistortion(const std::string& name, const std::vector<double>& D) {
  for (std::size_t i = 0; i < D.size(); ++i) {
    if (std::abs(D[i]) > kLargestCoefficient)
      refuse("D[" + std::to_string(i) + "] is " + numberText(D[i]), "a coefficient of distortion");
  }
  const DistortionModel* model = findModel(name);
  const std::size_t length = lengthWithoutZeros(D);
  const bool is_fisheye = name == "equidistant";  // bends images even if all of D is zero
  if (length == 0 && (!is_fisheye || !D.empty())) return;
  if (model == nullptr)
    refuse("distortion_model is \"" + name.substr(0, 40) + "\"",
           "plumb_bob, rational_polynomial or equidistant, as D is not zero");
  if (length > model->counts.back() || D.size() < model->counts.front())
    refuse("D has " + std::to_string(D.size()) + " coefficients for " + name, model->expected);
}

}  // namespace

void validate(const CameraCalibration& calibration) {
  requireUsableSize("camera_info", calibration.width, calibration.height);
  requireFinite("K", calibration.K);
  requireFinite("D", calibration.D);
  requireFinite("P", calibration.P);
  if (calibration.K[0] == 0.0)
    refuse("K[0] is 0: the camera is not calibrated", "the focal length in pixels");
  validateCameraMatrix(kLayoutOfK, calibration.K, calibration.width);
  if (calibration.P[0] != 0.0) validateCameraMatrix(kLayoutOfP, calibration.P, calibration.width);
  validateDistortion(calibration.distortion_model, calibration.D);
}

bool CameraCalibration::operator==(const CameraCalibration& other) const {
  return width == other.width && height == other.height && distortion_model == other.distortion_model &&
         D == other.D && K == other.K && R == other.R && P == other.P;
}

std::string unusedParts(const CameraCalibration& calibration) {
  const auto& P = calibration.P;
  const std::array<double, 9> identity{1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  std::string parts;
  if (!allZero(calibration.R) && calibration.R != identity) parts = "R";
  if (P[3] != 0.0 || P[7] != 0.0 || P[11] != 0.0) parts += parts.empty() ? "P[3]" : " and P[3]";
  return parts;
}

CameraCalibration ofSection(const CameraCalibration& full, const ImageSection& section) {
  const auto refuseUnless = [](bool is_good, const std::string& field, const std::string& expected) {
    if (!is_good) refuse(field, expected);
  };
  const int width = section.width == 0 ? full.width - section.x : section.width;
  const int height = section.height == 0 ? full.height - section.y : section.height;
  refuseUnless(
      section.x >= 0 && width > 0 && width <= full.width - section.x,
      "roi has x_offset " + std::to_string(section.x) + " and width " + std::to_string(section.width),
      "a part of an image that is " + std::to_string(full.width) + " wide");
  refuseUnless(
      section.y >= 0 && height > 0 && height <= full.height - section.y,
      "roi has y_offset " + std::to_string(section.y) + " and height " + std::to_string(section.height),
      "a part of an image that is " + std::to_string(full.height) + " high");
  const int binning_x = std::max(section.binning_x, 1), binning_y = std::max(section.binning_y, 1);
  CameraCalibration part = full;
  part.width = width / binning_x;
  part.height = height / binning_y;
  const auto adapt = [&](const MatrixLayout& layout, auto& matrix) {
    matrix[layout.cx] = (matrix[layout.cx] - section.x + 0.5) / binning_x - 0.5;
    matrix[layout.cy] = (matrix[layout.cy] - section.y + 0.5) / binning_y - 0.5;
    matrix[layout.fx] /= binning_x;
    matrix[layout.fy] /= binning_y;
  };
  adapt(kLayoutOfK, part.K);
  if (part.P[0] != 0.0) adapt(kLayoutOfP, part.P);
  return part;
}

CameraCalibration ofRectifiedImages(const CameraCalibration& raw) {
  CameraCalibration rectified = raw;
  rectified.distortion_model = "plumb_bob";  // other models bend images even without coefficients
  rectified.D.clear();
  const PinholeCamera camera = rectifiedCamera(raw);
  rectified.K = {camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0};
  return rectified;
}

std::vector<double> usedCoefficients(const CameraCalibration& calibration) {
  const std::size_t length = lengthWithoutZeros(calibration.D);
  const DistortionModel* model = findModel(calibration.distortion_model);
  const bool is_fisheye = calibration.distortion_model == "equidistant";
  if (model == nullptr || (length == 0 && !is_fisheye)) return {};
  const auto count = std::lower_bound(model->counts.begin(), model->counts.end(), length);
  std::vector<double> used = calibration.D;
  used.resize(count == model->counts.end() ? model->counts.back() : *count, 0.0);
  return used;
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
  if (colour.width != depth.width || colour.height != depth.height) return std::nullopt;
  const double width = colour.width, height = colour.height;
  const Field fields[] = {
      {"K[0]", colour.K[0], depth.K[0], kRelativeTolerance * colour.K[0]},
      {"K[4]", colour.K[4], depth.K[4], kRelativeTolerance * colour.K[4]},
      {"K[2]", colour.K[2], depth.K[2], kRelativeTolerance * width},
      {"K[5]", colour.K[5], depth.K[5], kRelativeTolerance * height},
  };
  for (const Field& field : fields) {
    if (std::abs(field.colour - field.depth) <= field.tolerance) continue;
    return std::string(field.name) + " is " + numberText(field.depth) +
           " in the depth image's camera_info and " + numberText(field.colour) + " in the colour image's";
  }
  return std::nullopt;
}

}  // namespace rgbd_sfm_fusion
