// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// A keyframe as published, with its stereo depth. Never changes after it was made.
struct KeyframeMap {
  Stamp stamp = kNoStamp;
  std::uint32_t revision = 0;  ///< counts refinements of the same keyframe, from 0
  PinholeCamera camera;  ///< that poses and depth go with: the given one, with the principal point as it was
                         ///< learned up to this keyframe
  SE3 T_first_keyframe;  ///< pose in the optical frame of the first tracked image; tracker units
  GreyImage grey;
  GaussianDepth depth;  ///< tracker units; from stereo alone, never from sensor depth (method.md 6). Under a
                        ///< rolling shutter, each row has the depth at the time when it was read, while poses
                        ///< are of the middle row. The variance includes the uncertainty of the readout time
};

}  // namespace rgbd_sfm_fusion
