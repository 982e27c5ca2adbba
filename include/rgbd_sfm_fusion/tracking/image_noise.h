// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

namespace rgbd_sfm_fusion {

/// [grey levels] Standard deviation of one pixel's brightness, learned from aligned points: the camera's
/// noise, and also compression, blur and all that alignment cannot explain. The noise decides how much the
/// uncertainty of points' depths counts. If the noise is too large, uncertain depths count as much as good
/// ones and bias the motion.
class ImageNoise {
 public:
  /// @param expected  where learning starts from, and the largest value that learning can reach
  explicit ImageNoise(double expected) : expected_(expected), sigma_(expected) {}

  /// Learns from an aligned frame. Frames differ, so each of them changes the noise by a small factor only.
  /// More noise than expected comes from wrong poses and depths, not from the camera.
  void observe(double of_frame) {
    constexpr double kGain = 0.1;
    constexpr double kLeast = 0.25;  // of the expected noise: pixels have whole grey levels
    const double bounded = std::clamp(of_frame, kLeast * expected_, expected_);
    if (std::isfinite(bounded)) sigma_ *= std::pow(bounded / sigma_, kGain);
  }

  double sigma() const { return sigma_; }

 private:
  double expected_, sigma_;
};

}  // namespace rgbd_sfm_fusion
