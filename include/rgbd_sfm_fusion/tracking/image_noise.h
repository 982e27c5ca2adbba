// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

namespace rgbd_sfm_fusion {

/// [grey levels] How far the brightness of aligned points differs, as a standard deviation of one pixel: a
/// camera's noise, and also compression, blur and what alignment cannot explain. It decides how much the
/// uncertainty of points' depths counts: with too large a noise uncertain depths count as much as good ones,
/// and bias the motion.
class ImageNoise {
 public:
  /// @param expected  where learning starts from, and the largest that it comes to
  explicit ImageNoise(double expected) : expected_(expected), sigma_(expected) {}

  /// What an aligned frame says. Frames differ, so that it counts in small steps, as a factor. More than is
  /// expected comes from poses and depths that are wrong, not from the camera.
  void observe(double of_frame) {
    constexpr double kGain = 0.1;
    constexpr double kLeast = 0.25;  // of what is expected: pixels are of whole grey levels
    const double bounded = std::clamp(of_frame, kLeast * expected_, expected_);
    if (std::isfinite(bounded)) sigma_ *= std::pow(bounded / sigma_, kGain);
  }

  double sigma() const { return sigma_; }

 private:
  double expected_, sigma_;
};

}  // namespace rgbd_sfm_fusion
