// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// The rims of the sensor's holes. SfM's depth there is as often that of the one side as of the other.
class Rims {
 public:
  /// @param sensor  [m], [m^2] H x W, NaN = none
  /// @param width   [px] of what is near to sensor depth, from 0 to 100; 0: nothing is
  void find(const GaussianDepth& sensor, int width);

  /// Drops SfM depth where the sensor has none, but some near. Against exact truth, a fifth of it is more
  /// than 5 sigma off, and no variance tells which.
  /// @param sfm  H x W, NaN = none
  void dropInHoles(GaussianDepth& sfm) const;

 private:
  cv::Mat_<std::uint8_t> marks_, near_;  ///< of each pixel, and of all that are near to it
  std::vector<std::uint8_t> rows_;       ///< work space
};

}  // namespace rgbd_sfm_fusion
