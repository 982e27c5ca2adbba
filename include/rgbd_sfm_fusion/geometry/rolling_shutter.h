// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/geometry/se3.h"

namespace rgbd_sfm_fusion {

/// A camera that reads its rows one after another moves while it does so (method.md 10). The pose of an image
/// is that of its middle row; the twist is the motion from the first row to the last, so that row v of
/// `height` has T_row_image = exp(s(v) twist). The motion is small: exp(x) is taken as 1 + x.
struct ReadoutMotion {
  Vector6 twist = Vector6::Zero();  ///< zero: all rows at once

  /// From -½ at the upper edge of an image to ½ at the lower one; the same on all levels of a pyramid.
  static double share(double v, int height) { return (v + 0.5) / height - 0.5; }

  SE3 T_row_image(double v, int height) const { return SE3::exp(share(v, height) * twist); }
};

}  // namespace rgbd_sfm_fusion
