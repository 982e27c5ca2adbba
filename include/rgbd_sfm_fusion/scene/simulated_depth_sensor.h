// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "rgbd_sfm_fusion/scene/rasteriser.h"

namespace rgbd_sfm_fusion {

/// What a structured-light sensor makes of the true depth. Noise and rounding act on inverse depth, as they
/// do on the disparity that is measured; together they give the σ_Z = 1.425e-3 Z² of method.md 1.
struct DepthSensorOptions {
  bool noise = true;        ///< noise and rounding to disparity steps (rounding to millimetres remains)
  bool shadow = true;       ///< no depth where the projector's light does not reach
  bool materials = true;    ///< no depth on anything but matte surfaces
  double step = 2.85e-3;    ///< [1/m] of inverse depth; Khoshelham & Elberink 2012
  double sigma = 0.41;      ///< [step]
  double baseline = 0.075;  ///< [m] the projector is this far to the left of the camera
  double min_range = 0.6;   ///< [m]
  double max_range = 5.0;   ///< [m]

  /// [1] A device's own calibration error: one factor on all its depths, spread like this over seeds. It is
  /// part of the noise: without `noise` there is none.
  double scale_sigma = 0.005;
};

/// The factor of a seed. Seeds in a row spread over the Gaussian evenly, so that any five of them are
/// representative.
double depthScale(double scale_sigma, std::uint64_t seed);

class SimulatedDepthSensor {
 public:
  /// @throws std::invalid_argument naming the option that is out of range
  SimulatedDepthSensor(const DepthSensorOptions& options, std::uint64_t seed);

  /// @param patches the patches that were drawn
  /// @param depth   CV_16UC1 [mm], 0 = none; allocated if need be
  void measure(const GeometryBuffer& geometry, const std::vector<Patch>& patches, double fx,
               std::uint32_t frame, cv::Mat& depth);

 private:
  void findShadow(const float* inverse_depth, int width, float disparity_scale, std::uint8_t* lit);

  DepthSensorOptions options_;
  std::uint64_t seed_;
  double scale_;
  std::vector<int> columns_;        ///< for each pixel of a row: the projector's column
  std::vector<float> projector_;    ///< nearest inverse depth by projector column
  std::vector<std::uint8_t> seen_;  ///< by surface index: 1 where the material returns light
  std::vector<std::uint8_t> lit_;   ///< for each pixel of a row: 1 where light comes back
};

}  // namespace rgbd_sfm_fusion
