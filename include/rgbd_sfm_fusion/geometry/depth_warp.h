// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Where the pixels of a depth image go when the camera moves: pixel q = (x, y, 1) with depth μ goes to
/// (u Z', v Z', Z') = μ A q + b, with A = K R K⁻¹ and b = K t: the paper's Eq. 5 to 7 in
/// one. Single precision.
class DepthWarp {
 public:
  DepthWarp(const PinholeCamera& camera, const SE3& T_target_source);

  struct Point {
    float u, v;  ///< [px] in the target; u = -1 where the point is behind the camera or out of the image
    float z;     ///< depth in the target
  };
  Point operator()(int x, int y, float depth) const {
    const Eigen::Vector3f q(static_cast<float>(x), static_cast<float>(y), 1.0f);
    const Eigen::Vector3f p = depth * (A_ * q) + b_;
    return inView(p.x() / p.z(), p.y() / p.z(), p.z(), static_cast<float>(width_),
                  static_cast<float>(height_));
  }

  /// Warps all pixels of row `y`. The arrays have the image's width. `u` is -1 for pixels without depth, too.
  void row(int y, const float* depth, float* u, float* v, float* z) const;

  /// The same, with the index (row by row) of the pixel nearest to each point; -1 if there is none.
  void row(int y, const float* depth, int* pixel, float* z) const;

  /// Warps `count` points of row `y`. Gives the index of the pixel nearest to each point, -1 if there is
  /// none, and the point's depth.
  void points(int y, const int* columns, const float* depth, int count, int* pixels, float* z) const;

  /// ∂Z'/∂μ of pixel (x, y): the same at any depth.
  float depthGain(int x, int y) const {
    return A_(2, 0) * static_cast<float>(x) + A_(2, 1) * static_cast<float>(y) + A_(2, 2);
  }

  /// Keeps a point that is in front of the camera and nearest to a pixel of the image; else sets u = -1.
  static Point inView(float u, float v, float z, float width, float height) {
    const bool visible = (z > 0.0f) & (u >= -0.5f) & (u < width - 0.5f) & (v >= -0.5f) & (v < height - 0.5f);
    return {visible ? u : -1.0f, v, z};
  }

  int width() const { return width_; }
  int height() const { return height_; }

 private:
  Eigen::Matrix3f A_;
  Eigen::Vector3f b_;
  int width_, height_;
};

/// True only for the exact identity.
bool isIdentity(const SE3& T);

}  // namespace rgbd_sfm_fusion
