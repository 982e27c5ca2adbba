// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {

/// Affine brightness: I_frame = gain * I_keyframe + offset.
struct Brightness {
  double gain = 1.0;
  double offset = 0.0;  ///< [grey levels]

  /// The same image's brightness relative to another image. `other` is the other image's brightness relative
  /// to the same keyframe.
  Brightness relativeTo(const Brightness& other) const {
    const double relative_gain = gain / other.gain;
    return {relative_gain, offset - relative_gain * other.offset};
  }
};

/// What an image of eight bits shows of a brightness [grey levels]: a window stays white when the exposure
/// grows.
inline float shown(float brightness) {
  return lesser(greater(brightness, 0.0F), 255.0F);
}

}  // namespace rgbd_sfm_fusion
