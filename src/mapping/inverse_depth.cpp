// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/inverse_depth.h"

#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

RGBD_SFM_FUSION_MULTIVERSION
void invert(const float* __restrict mean, const float* __restrict variance, int count,
            float* __restrict depth, float* __restrict depth_variance) {
  for (int i = 0; i < count; ++i) {
    const bool exists = mean[i] > 0.0F;
    const float inverse = 1.0F / mean[i], squared = inverse * inverse;
    depth[i] = exists ? inverse : kNoDepth;
    depth_variance[i] = exists ? variance[i] * squared * squared : kNoDepth;
  }
}

}  // namespace

GaussianDepth toDepth(const InverseDepthImage& inverse_depth, ImagePool& pool) {
  const cv::Size size = inverse_depth.mean.size();
  GaussianDepth depth{pool.take<float>(size), pool.take<float>(size)};
  invert(inverse_depth.mean[0], inverse_depth.variance[0], static_cast<int>(inverse_depth.mean.total()),
         depth.mean[0], depth.variance[0]);
  return depth;
}

InverseDepthWarp::InverseDepthWarp(const PinholeCamera& camera, const SE3& T_to_from,
                                   const ReadoutMotion& from, const ReadoutMotion& to)
    : R_(T_to_from.rotationMatrix().cast<float>()),
      t_(T_to_from.translation().cast<float>()),
      from_velocity_(from.twist.head<3>().cast<float>()),
      from_rotation_(from.twist.tail<3>().cast<float>()),
      to_velocity_(to.twist.head<3>().cast<float>()),
      to_rotation_(to.twist.tail<3>().cast<float>()),
      fx_(static_cast<float>(camera.fx)),
      fy_(static_cast<float>(camera.fy)),
      cx_(static_cast<float>(camera.cx)),
      cy_(static_cast<float>(camera.cy)),
      width_(camera.width),
      height_(camera.height) {}

std::optional<InverseDepthWarp::Point> InverseDepthWarp::operator()(int column, int row,
                                                                    float inverse_depth) const {
  constexpr float kMinDepthRatio = 0.1F;  // depth after the move over depth before it
  const Eigen::Vector3f ray((static_cast<float>(column) - cx_) / fx_, (static_cast<float>(row) - cy_) / fy_,
                            1.0F);
  const auto share = [this](float v) { return (v + 0.5F) / static_cast<float>(height_) - 0.5F; };
  const Eigen::Vector3f middle =
      ray - share(static_cast<float>(row)) * (from_rotation_.cross(ray) + inverse_depth * from_velocity_);
  Eigen::Vector3f point = R_ * middle + inverse_depth * t_;
  if (point.z() < kMinDepthRatio) return std::nullopt;
  point +=
      share(fy_ * point.y() / point.z() + cy_) * (to_rotation_.cross(point) + inverse_depth * to_velocity_);
  if (point.z() < kMinDepthRatio) return std::nullopt;
  const float u = fx_ * point.x() / point.z() + cx_ + 0.5F, v = fy_ * point.y() / point.z() + cy_ + 0.5F;
  const bool in_view =
      u >= 0.0F && v >= 0.0F && u < static_cast<float>(width_) && v < static_cast<float>(height_);
  if (!in_view) return std::nullopt;
  // ρ' = ρ / (r_z + ρ t_z), so dρ'/dρ = r_z / (r_z + ρ t_z)².
  const float derivative = (point.z() - inverse_depth * t_.z()) / (point.z() * point.z());
  return Point{static_cast<int>(u),       static_cast<int>(v), u - 0.5F, v - 0.5F,
               inverse_depth / point.z(), derivative};
}

}  // namespace rgbd_sfm_fusion
