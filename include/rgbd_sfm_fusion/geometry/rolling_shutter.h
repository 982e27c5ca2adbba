// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/geometry/se3.h"

namespace rgbd_sfm_fusion {

/// The motion of a camera that reads its rows one after another (method.md 10). An image has the pose of its
/// middle row. The twist is the motion from the first row to the last: row v of `height` has T_row_image =
/// exp(s(v) twist), where s is share(). The motion is small: exp(x) is taken as 1 + x.
struct ReadoutMotion {
  Vector6 twist = Vector6::Zero();  ///< zero: all rows at once

  /// The share of the twist at row v: -½ at the upper edge of an image, ½ at the lower edge. All levels of a
  /// pyramid have the same shares.
  static double share(double v, int height) { return (v + 0.5) / height - 0.5; }

  SE3 T_row_image(double v, int height) const { return SE3::exp(share(v, height) * twist); }
};

}  // namespace rgbd_sfm_fusion
