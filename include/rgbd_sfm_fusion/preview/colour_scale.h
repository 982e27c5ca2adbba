// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace rgbd_sfm_fusion {

/// Colours for a quantity over a fixed logarithmic range, so that the pictures of any two frames can be
/// compared. Values beyond the range get the colour of its end; NaN is black.
class ColourScale {
 public:
  struct Tick {
    double value;  ///< [m]
    std::string label;
  };

  /// @param colour_map  a value of cv::ColormapTypes
  /// @param backwards   the first tick gets the map's last colour
  /// @param ticks       for the bar beside the picture; the first and the last are the ends of the range
  ColourScale(int colour_map, bool backwards, std::vector<Tick> ticks);

  /// For depth: turbo, 0.4 m to 10 m. Equal ratios of depth are equal steps of colour, near and far.
  static const ColourScale& depth();
  /// For standard deviations: viridis, 1 mm to 1 m. Smaller is brighter.
  static const ColourScale& standardDeviation();

  /// RGB.
  cv::Vec3b colour(float value) const;
  /// The colour of each pixel of `values` [m].
  cv::Mat_<cv::Vec3b> paint(const cv::Mat_<float>& values) const;

  const std::vector<Tick>& ticks() const { return ticks_; }
  /// Place on the bar, 0 (first tick) to 1 (last).
  double place(double value) const;

 private:
  std::vector<Tick> ticks_;
  double log_first_, log_range_;
  std::array<cv::Vec3b, 256> colours_;  ///< RGB
};

}  // namespace rgbd_sfm_fusion
