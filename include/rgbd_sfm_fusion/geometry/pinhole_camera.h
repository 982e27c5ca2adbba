// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace rgbd_sfm_fusion {

/// A camera without distortion. Integer pixel coordinates are pixel centres: pixel (0, 0) covers
/// [-0.5, 0.5] x [-0.5, 0.5].
struct PinholeCamera {
  int width = 0;    ///< [px]
  int height = 0;   ///< [px]
  double fx = 0.0;  ///< [px]
  double fy = 0.0;  ///< [px]
  double cx = 0.0;  ///< [px]
  double cy = 0.0;  ///< [px]

  /// Pixel of a point in the optical frame (x right, y down, z forward; any unit, z > 0).
  /// Paper, Eq. 7 (re-projection) with (δx, δy) = 0: images are rectified.
  Eigen::Vector2d project(const Eigen::Vector3d& point) const {
    return {fx * point.x() / point.z() + cx, fy * point.y() / point.z() + cy};
  }

  /// Point at `depth` on the ray of pixel (x, y). Paper, Eq. 5 (back-projection).
  Eigen::Vector3d backProject(double x, double y, double depth) const {
    return {(x - cx) / fx * depth, (y - cy) / fy * depth, depth};
  }

  /// The camera of an image of half the size, in which each pixel averages 2 x 2 pixels of this camera's
  /// image.
  PinholeCamera halved() const {
    return {width / 2, height / 2, 0.5 * fx, 0.5 * fy, 0.5 * (cx + 0.5) - 0.5, 0.5 * (cy + 0.5) - 0.5};
  }
};

inline bool operator==(const PinholeCamera& a, const PinholeCamera& b) {
  return a.width == b.width && a.height == b.height && a.fx == b.fx && a.fy == b.fy && a.cx == b.cx &&
         a.cy == b.cy;
}
inline bool operator!=(const PinholeCamera& a, const PinholeCamera& b) {
  return !(a == b);
}

}  // namespace rgbd_sfm_fusion
