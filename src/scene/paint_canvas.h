// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// What the paints have in common.
#pragma once

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "rgbd_sfm_fusion/scene/noise.h"
#include "rgbd_sfm_fusion/scene/paints.h"

namespace rgbd_sfm_fusion {

inline cv::Size texels(double width, double height, double texel) {
  const auto count = [texel](double length) {
    return std::max(4, static_cast<int>(std::lround(length / texel)));
  };
  return {count(width), count(height)};
}

inline cv::Vec3b toTexel(const Colour& c) {
  return {cv::saturate_cast<std::uint8_t>(c[0]), cv::saturate_cast<std::uint8_t>(c[1]),
          cv::saturate_cast<std::uint8_t>(c[2])};
}

/// An image of colour(x, y), x and y in metres from the upper left corner.
template <class ColourAt>
cv::Mat paintEach(double width, double height, double texel, const ColourAt& colour) {
  cv::Mat image(texels(width, height, texel), CV_8UC3);
  for (int row = 0; row < image.rows; ++row) {
    auto* out = image.ptr<cv::Vec3b>(row);
    for (int x = 0; x < image.cols; ++x) out[x] = toTexel(colour((x + 0.5) * texel, (row + 0.5) * texel));
  }
  return image;
}

/// Distance to the nearest multiple of `period`.
inline double distanceToGrid(double x, double period) {
  return std::abs(x - period * std::round(x / period));
}

inline int cell(double x, double period) {
  return static_cast<int>(std::floor(x / period));
}

inline float smoothStep(double x, double low, double high) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return static_cast<float>(t * t * (3.0 - 2.0 * t));
}

}  // namespace rgbd_sfm_fusion
