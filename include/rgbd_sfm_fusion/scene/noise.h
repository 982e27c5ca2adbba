// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace rgbd_sfm_fusion {

/// Smooth random waves of many lengths added up, about -1 to 1.
struct FractalNoise {
  double longest = 128.0;     ///< [texel] wavelength of the first octave; the last one has about 2
  double persistence = 0.75;  ///< amplitude of an octave, relative to the one before
  double stretch = 1.0;       ///< how much longer the waves are along x
};

cv::Mat_<float> fractalNoise(cv::Size size, const FractalNoise& noise, std::uint32_t seed);

/// A random number in [0, 1) for cell (x, y) of a pattern: always the same number for the same cell and seed.
float cellRandom(int x, int y, std::uint32_t seed);

/// Multiplies an image (CV_8UC3) by 1 + strength * fractal noise.
void addDirt(cv::Mat& rgb, double strength, const FractalNoise& noise, std::uint32_t seed);

}  // namespace rgbd_sfm_fusion
