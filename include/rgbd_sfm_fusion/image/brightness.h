// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

}  // namespace rgbd_sfm_fusion
