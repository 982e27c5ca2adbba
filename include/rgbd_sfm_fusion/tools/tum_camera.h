// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>

namespace rgbd_sfm_fusion {

/// The camera of a recording in the layout of the TUM RGB-D benchmark.
struct TumCamera {
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< [px]
  int width = 0, height = 0;                      ///< [px]; 0: the images' size
  double depth_scale = 5000.0;  ///< [1/m] metres = value in the PNG / depth_scale; TUM's is the default
  std::array<double, 5> distortion{};  ///< plumb_bob k1 k2 p1 p2 k3
};

/// @param text  `freiburg1`, `freiburg2` or `freiburg3` (as the benchmark's page has them), `icl`
///              (ICL-NUIM), or fx,fy,cx,cy in pixels. A negative fy, as ICL-NUIM has it, means a y axis
///              that points up. The axis is turned down; the images stay as they are
/// @throws std::runtime_error for anything else, listing these
TumCamera parseTumCamera(const std::string& text);

/// `freiburg1` to `freiburg3`, if the folder's name says so as those of the archives do; else empty.
std::string tumCameraOf(const std::string& folder_name);

}  // namespace rgbd_sfm_fusion
