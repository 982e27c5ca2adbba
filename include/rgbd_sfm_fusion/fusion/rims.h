// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Where the sensor's surfaces end: the rims of its holes, and its depth steps. SfM's depth there is as often
/// that of the one side as of the other.
class Rims {
 public:
  /// @param sensor            [m], [m^2] H x W, NaN = none
  /// @param surface_variance  [m^2] H x W, as from withNoise(): below that of `sensor` beside a step,
  ///                          unless the noise has no lateral sigma
  /// @param width             [px] of what is near to a hole, to sensor depth, or to the pixels on both sides
  ///                          of a step, from 0 to 100; 0: nothing is
  void find(const GaussianDepth& sensor, const cv::Mat_<float>& surface_variance, int width);

  /// Drops SfM depth where the sensor has none, but some near. Against exact truth, a fifth of it is more
  /// than 5 sigma off, and no variance tells which.
  /// @param sfm  H x W, NaN = none
  void dropInHoles(GaussianDepth& sfm) const;

  /// Puts the sensor's surface in doubt, by NaN, near its holes and steps: against exact truth, averages with
  /// SfM's depth are worse there than the sensor's alone.
  void doubtSurface(cv::Mat_<float>& surface_variance) const;

 private:
  cv::Mat_<std::uint8_t> marks_, near_;  ///< of each pixel, and of all that are near to it
  std::vector<std::uint8_t> rows_;       ///< work space
};

}  // namespace rgbd_sfm_fusion
