// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/tracking_depth.h"

#include <algorithm>
#include <cmath>

#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

constexpr float kCarriedRelativeSigma = 0.02F;  // added to what is carried over to a new keyframe
constexpr float kRandomSigma = 0.3F;
constexpr float kAgreement = 9.0F;  // [σ²] between stereo and base; beyond it, stereo is new

RGBD_SFM_FUSION_MULTIVERSION
void fuseRow(const float* __restrict base_mean, const float* __restrict base_variance,
             const float* __restrict stereo_mean, const float* __restrict stereo_variance,
             float* __restrict mean, float* __restrict variance, int width) {
  for (int u = 0; u < width; ++u) {
    const float w0 = 1.0F / base_variance[u], w1 = 1.0F / stereo_variance[u];
    const float difference = base_mean[u] - stereo_mean[u];
    const bool both = (w0 > 0.0F) & (w1 > 0.0F);
    const bool agree = difference * difference < kAgreement * (base_variance[u] + stereo_variance[u]);
    // Where they contradict each other one of them is wrong; tracking does without.
    const float weight = both & !agree ? 0.0F : w0 + w1;
    mean[u] = weight > 0.0F ? (w0 * base_mean[u] + w1 * stereo_mean[u]) / weight : 0.0F;
    variance[u] = weight > 0.0F ? 1.0F / weight : kInfinity;
  }
}

RGBD_SFM_FUSION_MULTIVERSION
void invertRow(const float* __restrict depth, const float* __restrict depth_variance, float* __restrict mean,
               float* __restrict variance, int count) {
  for (int i = 0; i < count; ++i) {
    const bool exists = depth[i] > 0.0F;
    const float inverse = 1.0F / depth[i], squared = inverse * inverse;
    mean[i] = exists ? inverse : mean[i];
    variance[i] = exists ? depth_variance[i] * squared * squared : variance[i];
  }
}

}  // namespace

TrackingDepth::TrackingDepth(const PinholeCamera& camera) : camera_(camera) {
  base_.create({camera.width, camera.height});
  fused_.create({camera.width, camera.height});
  clear();
}

void TrackingDepth::clear() {
  base_.clear();
}

void TrackingDepth::setSensor(const GaussianDepth& depth) {
  invertRow(depth.mean[0], depth.variance[0], base_.mean[0], base_.variance[0],
            static_cast<int>(depth.mean.total()));
}

void TrackingDepth::setRandom() {
  constexpr int kPatch = 16;  // [px] depths that change with every pixel would average out in the pyramid
  cv::RNG random(1);
  for (int v = 0; v < camera_.height; v += kPatch) {
    for (int u = 0; u < camera_.width; u += kPatch) {
      const cv::Rect patch(u, v, std::min(kPatch, camera_.width - u), std::min(kPatch, camera_.height - v));
      base_.mean(patch).setTo(random.uniform(0.7, 1.3));
    }
  }
  base_.variance.setTo(kRandomSigma * kRandomSigma);
}

void TrackingDepth::moveTo(const SE3& T_new_old) {
  InverseDepthImage moved;
  moved.create(base_.mean.size());
  moved.clear();
  const Eigen::Matrix3f R = T_new_old.rotationMatrix().cast<float>();
  const Eigen::Vector3f t = T_new_old.translation().cast<float>();
  const auto fx = static_cast<float>(camera_.fx), fy = static_cast<float>(camera_.fy);
  const auto cx = static_cast<float>(camera_.cx), cy = static_cast<float>(camera_.cy);
  for (int v = 0; v < camera_.height; ++v) {
    for (int u = 0; u < camera_.width; ++u) {
      const float rho = fused_.mean(v, u);
      if (!(rho > 0.0F)) continue;
      const Eigen::Vector3f ray((static_cast<float>(u) - cx) / fx, (static_cast<float>(v) - cy) / fy, 1.0F);
      const Eigen::Vector3f point = R * ray + rho * t;
      if (point.z() < 0.1F) continue;
      const float to_u = fx * point.x() / point.z() + cx, to_v = fy * point.y() / point.z() + cy;
      const int column = static_cast<int>(to_u + 0.5F), row = static_cast<int>(to_v + 0.5F);
      if (to_u < 0.0F || to_v < 0.0F || column >= camera_.width || row >= camera_.height) continue;
      const float to_rho = rho / point.z();
      if (to_rho < moved.mean(row, column)) continue;
      const float derivative = (point.z() - rho * t.z()) / (point.z() * point.z());
      const float noise = kCarriedRelativeSigma * to_rho;
      moved.mean(row, column) = to_rho;
      moved.variance(row, column) = derivative * derivative * fused_.variance(v, u) + noise * noise;
    }
  }
  std::swap(base_, moved);
}

const InverseDepthImage& TrackingDepth::fuse(const InverseDepthImage& stereo) {
  for (int v = 0; v < camera_.height; ++v) {
    fuseRow(base_.mean[v], base_.variance[v], stereo.mean[v], stereo.variance[v], fused_.mean[v],
            fused_.variance[v], camera_.width);
  }
  return fused_;
}

}  // namespace rgbd_sfm_fusion
