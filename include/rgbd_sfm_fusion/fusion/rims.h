// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// The rims of the sensor's holes. There, SfM's depth may belong to either side.
class Rims {
 public:
  /// @param sensor  [m], [m^2] H x W, NaN = none
  /// @param width   [px] from sensor depth within which a pixel is near to it, from 0 to 100; 0: none is
  void find(const GaussianDepth& sensor, int width);

  /// Drops SfM depth of pixels that have no sensor depth, but sensor depth near. Against exact truth, a fifth
  /// of this SfM depth is more than 5 sigma off, and no variance tells which.
  /// @param sfm  H x W, NaN = none
  void dropInHoles(GaussianDepth& sfm) const;

 private:
  cv::Mat_<std::uint8_t> marks_, near_;  ///< 1 for sensor depth at the pixel, and for sensor depth near to it
  std::vector<std::uint8_t> rows_;       ///< work space
};

}  // namespace rgbd_sfm_fusion
