// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Data that passes between the stages. Images are row-major, `(row, column)` = `(y, x)`, and rectified
/// unless a name says `raw`. Depth is Z along the optical axis, not the length of the ray.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/core.hpp>

namespace rgbd_sfm_fusion {

/// Time of an image [ns], as in its message header. Signed, so that differences are plain subtractions.
using Stamp = std::int64_t;

constexpr Stamp kNoStamp = -1;

constexpr double toSeconds(Stamp duration) {
  return 1e-9 * static_cast<double>(duration);
}

inline Stamp fromSeconds(double duration) {
  return static_cast<Stamp>(std::llround(1e9 * duration));
}

/// Brightness, 0 to 255.
using GreyImage = cv::Mat_<std::uint8_t>;

/// [m] or tracker units; NaN = none. There are no zeros, infinities or negative values.
using DepthImage = cv::Mat_<float>;

/// Depth and variance of a pixel without depth.
constexpr float kNoDepth = std::numeric_limits<float>::quiet_NaN();

/// Per-pixel Gaussian depth. Where `mean` is NaN, so is `variance`; elsewhere both are finite and > 0.
/// Both are empty, or both have the camera's size.
struct GaussianDepth {
  DepthImage mean;           ///< [m] or tracker units
  cv::Mat_<float> variance;  ///< the same unit, squared; of depth, not of inverse depth
};

/// A colour image, as brightness, with the sensor depth that belongs to it. Both are rectified.
struct RgbdFrame {
  Stamp stamp = kNoStamp;        ///< of the colour image
  GreyImage grey;                ///< H x W
  cv::Rect seen;                 ///< part of `grey` that the camera has seen; empty: all of it
  DepthImage depth;              ///< [m], H x W; empty where no depth image belongs to this colour image
  Stamp depth_stamp = kNoStamp;  ///< of the depth image; kNoStamp where there is none
};

}  // namespace rgbd_sfm_fusion
