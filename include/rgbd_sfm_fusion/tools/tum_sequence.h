// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "rgbd_sfm_fusion/tools/tum_camera.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// A recording in the layout of the TUM RGB-D benchmark: what its text files say.
struct TumSequence : TumCamera {
  /// A line of associations.txt; paths include the sequence's folder.
  struct Pair {
    Stamp rgb_stamp = kNoStamp;
    std::string rgb_path;
    Stamp depth_stamp = kNoStamp;
    std::string depth_path;
  };

  std::vector<Pair> pairs;           ///< in the file's order
  std::vector<std::string> files;    ///< text files that were read
  std::vector<std::string> remarks;  ///< what had to be assumed
};

/// What the folder does not say.
struct TumOptions {
  std::string camera;        ///< as parseTumCamera() takes it; empty: from calib.txt, or by the folder's name
  double depth_scale = 0.0;  ///< [1/m]; 0: the camera's
  double rate = 0.0;         ///< [Hz] stamps count images, which come at this rate; 0: stamps are seconds
};

/// Reads `calib.txt` (`fx fy cx cy w h depth_scale`, and a line `# dist k1 k2 p1 p2 k3`), and
/// `associations.txt` with colour or depth first. A freshly unpacked archive has neither. Then images in
/// `rgb.txt` and `depth.txt` are paired if they are at most 20 ms apart, as the benchmark's associate.py
/// does.
/// @throws std::runtime_error naming the file and the line that is missing or not understood, and the cure
TumSequence readTumSequence(const std::string& folder, const TumOptions& options = {});

/// Nanoseconds of a decimal number of seconds, exact to the last digit, which a double is not.
/// @throws std::runtime_error when the text is no number of seconds >= 0 that fits
Stamp parseStamp(const std::string& seconds);

}  // namespace rgbd_sfm_fusion
