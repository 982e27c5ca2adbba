// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace rgbd_sfm_fusion {

/// [grey levels] Standard deviation of one pixel's brightness, learned from aligned points: the camera's
/// noise, and also compression, blur and all that alignment cannot explain. The noise decides how much the
/// uncertainty of points' depths counts. If the noise is too large, uncertain depths count as much as good
/// ones and bias the motion.
class ImageNoise {
 public:
  /// @param expected  what holds before the first frame, and the largest value, unless an image by itself has
  ///                  more
  explicit ImageNoise(double expected) : expected_(expected), sigma_(expected) {}

  /// Looks at the next frame, before it is aligned.
  /// @param of_image  pixelNoise()
  void look(double of_image) { of_image_ = of_image; }

  /// Takes over an aligned frame's noise for the next one. It is not below that of rounding to whole grey
  /// levels, and never above what is expected, or what the image alone has: more comes from wrong poses and
  /// depths, not from the camera.
  void observe(double of_frame) {
    if (std::isfinite(of_frame))
      observed_ = sigma_ =
          std::min(std::max(of_frame, std::sqrt(1.0 / 12.0)), std::max(expected_, of_image_));
  }

  double sigma() const { return sigma_; }

  /// Of the image by itself. Both values take in more than that, so it is the lesser one.
  double ofImage() const { return std::min(of_image_, observed_); }

 private:
  double expected_, sigma_;
  double of_image_ = 0.0;
  double observed_ = std::numeric_limits<double>::infinity();  // sigma_, once there is one
};

}  // namespace rgbd_sfm_fusion
