// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/image/inverse_depth.h"

#include <algorithm>

#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

struct Vector3 {
  float x, y, z;
};

inline Vector3 cross(const float* a, const Vector3& b) {
  return {a[1] * b.z - a[2] * b.y, a[2] * b.x - a[0] * b.z, a[0] * b.y - a[1] * b.x};
}

/// The point moves on by a share of the motion during the readout: a turn, and a move over its depth.
inline Vector3 moved(const Vector3& point, float share, const float* rotation, const float* velocity,
                     float inverse_depth) {
  const Vector3 turned = cross(rotation, point);
  return {point.x + share * (turned.x + inverse_depth * velocity[0]),
          point.y + share * (turned.y + inverse_depth * velocity[1]),
          point.z + share * (turned.z + inverse_depth * velocity[2])};
}

RGBD_SFM_FUSION_MULTIVERSION
void warpRow(const InverseDepthWarp::Terms& terms, int row, const int* __restrict columns,
             const float* __restrict inverse_depths, std::size_t count, float* __restrict us,
             float* __restrict vs, int* __restrict pixels, float* __restrict warped,
             float* __restrict derivatives) {
  const InverseDepthWarp::Terms w = terms;
  const float inverse_height = 1.0F / static_cast<float>(w.height);
  const float middle =
      0.5F - 0.5F * inverse_height;  // a row's share of the readout: v * inverse_height - middle
  const float share = static_cast<float>(row) * inverse_height - middle;
  const float y = (static_cast<float>(row) - w.cy) / w.fy, inverse_fx = 1.0F / w.fx;
  for (std::size_t i = 0; i < count; ++i) {
    const float rho = inverse_depths[i];
    const Vector3 ray{(static_cast<float>(columns[i]) - w.cx) * inverse_fx, y, 1.0F};
    const Vector3 m = moved(ray, -share, w.from_rotation, w.from_velocity, rho);
    const Vector3 q{w.R[0] * m.x + w.R[1] * m.y + w.R[2] * m.z + rho * w.t[0],
                    w.R[3] * m.x + w.R[4] * m.y + w.R[5] * m.z + rho * w.t[1],
                    w.R[6] * m.x + w.R[7] * m.y + w.R[8] * m.z + rho * w.t[2]};
    const float share_there = (w.fy * q.y / q.z + w.cy) * inverse_height - middle;
    const Vector3 p = moved(q, share_there, w.to_rotation, w.to_velocity, rho);
    const float inverse_z = 1.0F / p.z;
    const float u = w.fx * p.x * inverse_z + w.cx, v = w.fy * p.y * inverse_z + w.cy;
    const bool in_view = (q.z > 0.0F) & (p.z > 0.0F) & (u >= -0.5F) & (v >= -0.5F) &
                         (u < static_cast<float>(w.width) - 0.5F) & (v < static_cast<float>(w.height) - 0.5F);
    const float seen_u = in_view ? u : 0.0F, seen_v = in_view ? v : 0.0F;
    us[i] = seen_u;
    vs[i] = seen_v;
    const int pixel = static_cast<int>(seen_v + 0.5F) * w.width + static_cast<int>(seen_u + 0.5F);
    pixels[i] = in_view ? pixel : -1;
    warped[i] = rho * inverse_z;
    // ρ' = ρ / (r_z + ρ t_z), so dρ'/dρ = r_z / (r_z + ρ t_z)².
    derivatives[i] = (p.z - rho * w.t[2]) * inverse_z * inverse_z;
  }
}

}  // namespace

void WarpedPoints::resize(std::size_t count) {
  u.resize(count);
  v.resize(count);
  pixel.resize(count);
  inverse_depth.resize(count);
  derivative.resize(count);
}

InverseDepthWarp::InverseDepthWarp(const PinholeCamera& camera, const SE3& T_to_from,
                                   const ReadoutMotion& from, const ReadoutMotion& to) {
  const Eigen::Matrix<float, 3, 3, Eigen::RowMajor> R = T_to_from.rotationMatrix().cast<float>();
  const Eigen::Vector3f t = T_to_from.translation().cast<float>();
  const Eigen::Matrix<float, 6, 1> from_twist = from.twist.cast<float>(), to_twist = to.twist.cast<float>();
  std::copy_n(R.data(), 9, terms_.R);
  std::copy_n(t.data(), 3, terms_.t);
  std::copy_n(from_twist.data(), 3, terms_.from_velocity);
  std::copy_n(from_twist.data() + 3, 3, terms_.from_rotation);
  std::copy_n(to_twist.data(), 3, terms_.to_velocity);
  std::copy_n(to_twist.data() + 3, 3, terms_.to_rotation);
  terms_.fx = static_cast<float>(camera.fx), terms_.fy = static_cast<float>(camera.fy);
  terms_.cx = static_cast<float>(camera.cx), terms_.cy = static_cast<float>(camera.cy);
  terms_.width = camera.width, terms_.height = camera.height;
}

void InverseDepthWarp::row(int row, const int* columns, const float* inverse_depths, std::size_t count,
                           std::size_t first, WarpedPoints& points) const {
  warpRow(terms_, row, columns, inverse_depths, count, &points.u[first], &points.v[first],
          &points.pixel[first], &points.inverse_depth[first], &points.derivative[first]);
}

}  // namespace rgbd_sfm_fusion
