// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// A recording in the layout of the TUM RGB-D benchmark, as far as text files tell.
struct TumSequence {
  /// A line of associations.txt; paths include the sequence's folder.
  struct Pair {
    Stamp rgb_stamp = kNoStamp;
    std::string rgb_path;
    Stamp depth_stamp = kNoStamp;
    std::string depth_path;
  };

  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< [px]
  int width = 0, height = 0;                      ///< [px]
  double depth_scale = 0.0;                       ///< [1/m] metres = value in the PNG / depth_scale
  std::array<double, 5> distortion{};             ///< plumb_bob k1 k2 p1 p2 k3, from a line `# dist …`
  std::vector<Pair> pairs;                        ///< in the file's order
};

/// Reads `associations.txt` and `calib.txt` of a folder.
/// @throws std::runtime_error naming the file and the line that is missing or not understood
TumSequence readTumSequence(const std::string& folder);

/// Nanoseconds of a decimal number of seconds, exact to the last digit, which a double is not.
/// @throws std::runtime_error when the text is no number of seconds >= 0 that fits
Stamp parseStamp(const std::string& seconds);

}  // namespace rgbd_sfm_fusion
