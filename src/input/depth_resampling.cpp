// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/depth_resampling.h"

#include <cmath>
#include <stdexcept>

#include "rgbd_sfm_fusion/tools/number_text.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kTolerance = 0.005;  // of focal lengths and sides, as for cameras of the same size

std::string text(const cv::Size& size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

std::string text(const CameraCalibration& camera) {
  std::string text = std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                     " px, fx = " + numberText(camera.K[0]) + ", fy = " + numberText(camera.K[4]) +
                     ", cx = " + numberText(camera.K[2]) + ", cy = " + numberText(camera.K[5]) + ", D =";
  for (const double coefficient : usedCoefficients(camera)) text += " " + numberText(coefficient);
  return usedCoefficients(camera).empty() ? text + " 0" : text;
}

/// One axis of an image.
struct Axis {
  double focal, centre, size;  ///< [px]
};

/// How the depth image lies in the colour image along an axis, in depth pixels.
struct Section {
  double before, after;  ///< the colour image extends so far beyond the depth image
  double scale;          ///< depth pixels per colour pixel

  Section(const Axis& colour, const Axis& depth)
      : before(depth.focal / colour.focal * colour.centre - depth.centre),
        after(depth.focal / colour.focal * colour.size - depth.size - before),
        scale(depth.focal / colour.focal) {}

  bool isWithin(double tolerance) const { return before >= -tolerance && after >= -tolerance; }
  bool isWhole(double tolerance) const { return before <= tolerance && after <= tolerance; }
};

/// Whether the depth image is the colour image, either scaled and cut along at most one axis, or cut without
/// being scaled. An image that is scaled, and cut along both axes, counts as another camera's: otherwise an
/// infrared camera would pass for the colour camera.
bool isSameCamera(const CameraCalibration& colour, const CameraCalibration& depth) {
  const double width = depth.width, height = depth.height;
  const Section x({colour.K[0], colour.K[2], static_cast<double>(colour.width)},
                  {depth.K[0], depth.K[2], width});
  const Section y({colour.K[4], colour.K[5], static_cast<double>(colour.height)},
                  {depth.K[4], depth.K[5], height});
  // Centres scaled from the pixels' corners differ by half a pixel from centres scaled from the pixels'
  // centres.
  const double tolerance_x = kTolerance * width + 1.0, tolerance_y = kTolerance * height + 1.0;
  const bool is_uniform = std::abs(x.scale / y.scale - 1.0) <= kTolerance;
  const bool is_within = x.isWithin(tolerance_x) && y.isWithin(tolerance_y);
  const bool is_scaled = x.isWhole(tolerance_x) || y.isWhole(tolerance_y);
  const bool is_cut_only = std::abs(x.scale - 1.0) <= kTolerance;
  const bool is_distorted_alike = usedCoefficients(colour) == usedCoefficients(depth);
  return is_uniform && is_within && (is_scaled || is_cut_only) && is_distorted_alike;
}

std::vector<int> nearest(const Axis& colour, const Axis& depth) {
  std::vector<int> places(static_cast<std::size_t>(colour.size), -1);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double place =
        std::round((static_cast<double>(i) - colour.centre) * depth.focal / colour.focal + depth.centre);
    if (place >= 0.0 && place < depth.size) places[i] = static_cast<int>(place);
  }
  return places;
}

}  // namespace

DepthResampling::DepthResampling(const CameraCalibration& colour,
                                 const std::optional<CameraCalibration>& depth)
    : colour_size_(colour.width, colour.height) {
  if (!depth) {
    refusal_ = ", and there is no camera_info of depth that says which part of the colour image it shows";
    return;
  }
  depth_size_ = {depth->width, depth->height};
  if (depth_size_ == colour_size_) {
    refusal_ = " as in camera_info";
    return;
  }
  try {
    validate(*depth);
  } catch (const std::invalid_argument& error) {
    refusal_ = ", and of depth's " + std::string(error.what());
    return;
  }
  if (!isSameCamera(colour, *depth)) {
    refusal_ = ", or of another size along the same rays; the cameras are: colour " + text(colour) +
               "; depth " + text(*depth) +
               ". Let the driver register depth to colour, or put depth_image_proc/register before";
    return;
  }
  columns_ = nearest({colour.K[0], colour.K[2], static_cast<double>(colour.width)},
                     {depth->K[0], depth->K[2], static_cast<double>(depth->width)});
  rows_ = nearest({colour.K[4], colour.K[5], static_cast<double>(colour.height)},
                  {depth->K[4], depth->K[5], static_cast<double>(depth->height)});
}

DepthImage DepthResampling::operator()(const DepthImage& depth) const {
  if (depth.size() == colour_size_) return depth;
  const std::string is = "is " + text(depth.size()) + ", expected ";
  if (!refusal_.empty()) throw std::invalid_argument(is + text(colour_size_) + refusal_);
  if (depth.size() != depth_size_)
    throw std::invalid_argument(is + text(depth_size_) + " as in its camera_info, or colour's " +
                                text(colour_size_));
  DepthImage resampled(colour_size_, kNoDepth);
  for (int y = 0; y < resampled.rows; ++y) {
    const int row = rows_[static_cast<std::size_t>(y)];
    if (row < 0) continue;
    for (int x = 0; x < resampled.cols; ++x) {
      const int column = columns_[static_cast<std::size_t>(x)];
      if (column >= 0) resampled(y, x) = depth(row, column);
    }
  }
  return resampled;
}

}  // namespace rgbd_sfm_fusion
