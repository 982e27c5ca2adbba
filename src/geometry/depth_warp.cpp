// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/geometry/depth_warp.h"

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

/// A point whose u is -1 unless it is in front of the camera and nearest to one of the image's pixels.
inline DepthWarp::Point inView(float z, float u, float v, float width, float height) {
  const bool visible = (z > 0.0f) & (u >= -0.5f) & (u < width - 0.5f) & (v >= -0.5f) & (v < height - 0.5f);
  return {visible ? u : -1.0f, v, z};
}

/// `a` is the first column of A, `c` what A q amounts to at x = 0.
RGBD_SFM_FUSION_MULTIVERSION
void warpRow(const float* depth, int width, int height, const float* a, const float* c, const float* b,
             float* u, float* v, float* z) {
  const float a0 = a[0], a1 = a[1], a2 = a[2], c0 = c[0], c1 = c[1], c2 = c[2];
  const float b0 = b[0], b1 = b[1], b2 = b[2];
  const float w = static_cast<float>(width), h = static_cast<float>(height);
  for (int i = 0; i < width; ++i) {
    const float x = static_cast<float>(i);
    const float mu = depth[i];
    const float depth_there = mu * (a2 * x + c2) + b2;
    const float inverse = 1.0f / depth_there;
    const DepthWarp::Point point =
        inView(depth_there, (mu * (a0 * x + c0) + b0) * inverse, (mu * (a1 * x + c1) + b1) * inverse, w, h);
    u[i] = point.u;
    v[i] = point.v;
    z[i] = point.z;
  }
}

}  // namespace

DepthWarp::DepthWarp(const PinholeCamera& camera, const SE3& T_target_source)
    : width_(camera.width), height_(camera.height) {
  Eigen::Matrix3d K;
  K << camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0;
  A_ = (K * T_target_source.rotationMatrix() * K.inverse()).cast<float>();
  b_ = (K * T_target_source.translation()).cast<float>();
}

DepthWarp::Point DepthWarp::operator()(int x, int y, float depth) const {
  const Eigen::Vector3f q(static_cast<float>(x), static_cast<float>(y), 1.0f);
  const Eigen::Vector3f p = depth * (A_ * q) + b_;
  return inView(p.z(), p.x() / p.z(), p.y() / p.z(), static_cast<float>(width_), static_cast<float>(height_));
}

void DepthWarp::row(int y, const float* depth, float* u, float* v, float* z) const {
  const Eigen::Vector3f a = A_.col(0);
  const Eigen::Vector3f c = A_.col(1) * static_cast<float>(y) + A_.col(2);
  warpRow(depth, width_, height_, a.data(), c.data(), b_.data(), u, v, z);
}

float DepthWarp::depthGain(int x, int y) const {
  return A_(2, 0) * static_cast<float>(x) + A_(2, 1) * static_cast<float>(y) + A_(2, 2);
}

bool isIdentity(const SE3& T) {
  return T.translation().isZero(0.0) && T.rotation().vec().isZero(0.0);
}

}  // namespace rgbd_sfm_fusion
