// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace rgbd_sfm_fusion {

struct ColourSensorOptions {
  bool blur = true;              ///< of the lens: 0.5 px
  double noise = 2.0;            ///< [grey level] standard deviation, in every channel
  double exposure_drift = 0.06;  ///< largest relative change of exposure, either way
  double drift_period = 7.0;     ///< [s]
};

/// What a plain camera makes of the true colours: blur, exposure, noise, 8 bits.
class SimulatedColourSensor {
 public:
  /// @throws std::invalid_argument naming the option that is out of range
  SimulatedColourSensor(const ColourSensorOptions& options, std::uint64_t seed);

  /// @param scene CV_8UC3, what there is to see
  /// @param time [s] since the start
  /// @param rgb  CV_8UC3; allocated if need be
  void expose(const cv::Mat& scene, double time, std::uint32_t frame, cv::Mat& rgb);

 private:
  double gain(double time) const;

  ColourSensorOptions options_;
  std::uint64_t seed_;
  std::vector<std::uint16_t> column_sums_;
  std::vector<std::uint16_t> noise_;
};

}  // namespace rgbd_sfm_fusion
