// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/geometry/depth_warp.h"

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

/// The warp of a row: the first column of A (a), the value of A q at x = 0 (c), and b.
struct RowWarp {
  Eigen::Vector3f a, c, b;
  float width, height;

  DepthWarp::Point operator()(int column, float mu) const {
    const float x = static_cast<float>(column);
    const float z = mu * (a[2] * x + c[2]) + b[2];
    const float inverse = 1.0f / z;
    return DepthWarp::inView((mu * (a[0] * x + c[0]) + b[0]) * inverse,
                             (mu * (a[1] * x + c[1]) + b[1]) * inverse, z, width, height);
  }
};

RowWarp rowWarp(const DepthWarp& warp, int y, const Eigen::Matrix3f& A, const Eigen::Vector3f& b) {
  return {A.col(0), A.col(1) * static_cast<float>(y) + A.col(2), b, static_cast<float>(warp.width()),
          static_cast<float>(warp.height())};
}

RGBD_SFM_FUSION_MULTIVERSION
void warpRow(const float* depth, int width, const RowWarp& reference, float* __restrict u,
             float* __restrict v, float* __restrict z) {
  const RowWarp warp = reference;
  for (int x = 0; x < width; ++x) {
    const DepthWarp::Point point = warp(x, depth[x]);
    u[x] = point.u;
    v[x] = point.v;
    z[x] = point.z;
  }
}

/// Index of the pixel nearest to a point; -1 if the point is in no pixel.
inline int nearestPixel(const DepthWarp::Point& point, int width) {
  const bool visible = point.u != -1.0f;
  const int column = static_cast<int>((visible ? point.u : 0.0f) + 0.5f);
  const int row = static_cast<int>((visible ? point.v : 0.0f) + 0.5f);
  return visible ? row * width + column : -1;
}

RGBD_SFM_FUSION_MULTIVERSION
void warpRowToPixels(const float* depth, int width, const RowWarp& reference, int* __restrict pixel,
                     float* __restrict z) {
  const RowWarp warp = reference;
  for (int x = 0; x < width; ++x) {
    const DepthWarp::Point point = warp(x, depth[x]);
    pixel[x] = nearestPixel(point, width);
    z[x] = point.z;
  }
}

RGBD_SFM_FUSION_MULTIVERSION
void warpPointsToPixels(const int* columns, const float* depth, int count, int width,
                        const RowWarp& reference, int* __restrict pixel, float* __restrict z) {
  const RowWarp warp = reference;
  for (int i = 0; i < count; ++i) {
    const DepthWarp::Point point = warp(columns[i], depth[i]);
    pixel[i] = nearestPixel(point, width);
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

void DepthWarp::row(int y, const float* depth, float* u, float* v, float* z) const {
  warpRow(depth, width_, rowWarp(*this, y, A_, b_), u, v, z);
}

void DepthWarp::row(int y, const float* depth, int* pixel, float* z) const {
  warpRowToPixels(depth, width_, rowWarp(*this, y, A_, b_), pixel, z);
}

void DepthWarp::points(int y, const int* columns, const float* depth, int count, int* pixels,
                       float* z) const {
  warpPointsToPixels(columns, depth, count, width_, rowWarp(*this, y, A_, b_), pixels, z);
}

bool isIdentity(const SE3& T) {
  return T.translation().isZero(0.0) && T.rotation().vec().isZero(0.0);
}

}  // namespace rgbd_sfm_fusion
