// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/tracking_reference.h"

#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr float kOutOfView = 1e6F;  // ray of the points that fill up the last block

inline float exists(float weight) {
  return weight > 0.0F ? 1.0F : 0.0F;
}

/// Weighted mean of the (up to four) depths that a coarser pixel covers. Its variance is their mean
/// variance, not a fourth of it: the errors of neighbours are correlated.
RGBD_SFM_FUSION_MULTIVERSION
void halveRow(const float* __restrict mean0, const float* __restrict mean1, const float* __restrict variance0,
              const float* __restrict variance1, float* __restrict mean, float* __restrict variance,
              int width) {
  for (int u = 0; u < width; ++u) {
    const float w00 = 1.0F / variance0[2 * u], w01 = 1.0F / variance0[2 * u + 1];
    const float w10 = 1.0F / variance1[2 * u], w11 = 1.0F / variance1[2 * u + 1];
    const float weight = w00 + w01 + w10 + w11;
    const float sum =
        w00 * mean0[2 * u] + w01 * mean0[2 * u + 1] + w10 * mean1[2 * u] + w11 * mean1[2 * u + 1];
    const float count = exists(w00) + exists(w01) + exists(w10) + exists(w11);
    // Without any depth, the mean is 0 / 1 and the variance 1 / 0, which is infinity. A branch would keep
    // this from becoming vector code.
    mean[u] = sum / (count > 0.0F ? weight : 1.0F);
    variance[u] = (count > 0.0F ? count : 1.0F) / weight;
  }
}

void halve(const InverseDepthImage& fine, InverseDepthImage& coarse) {
  coarse.create(fine.mean.size() / 2);
  for (int v = 0; v < coarse.mean.rows; ++v) {
    halveRow(fine.mean[2 * v], fine.mean[2 * v + 1], fine.variance[2 * v], fine.variance[2 * v + 1],
             coarse.mean[v], coarse.variance[v], coarse.mean.cols);
  }
}

void collect(const InverseDepthImage& depth, const cv::Mat_<float>& intensity, const ImageGradient& gradient,
             const cv::Rect& seen, float min_gradient, bool every_other, ReferencePoints& points) {
  const auto capacity = static_cast<std::size_t>(paddedToLanes(static_cast<int>(intensity.total())));
  for (auto* array : {&points.x, &points.y, &points.inverse_depth, &points.inverse_depth_variance,
                      &points.intensity, &points.gradient_x, &points.gradient_y}) {
    array->resize(capacity);
  }
  const auto inverse_fx = static_cast<float>(1.0 / points.camera.fx);
  const auto inverse_fy = static_cast<float>(1.0 / points.camera.fy);
  const auto cx = static_cast<float>(points.camera.cx), cy = static_cast<float>(points.camera.cy);
  const float min_squared = min_gradient * min_gradient;
  std::size_t n = 0;
  for (int v = seen.y + 1; v + 1 < seen.br().y; ++v) {
    const float *mean = depth.mean[v], *variance = depth.variance[v], *row = intensity[v];
    const float *gx = gradient.x[v], *gy = gradient.y[v];
    for (int u = seen.x + 1; u + 1 < seen.br().x; ++u) {
      // Values are written at every pixel and kept only at some: there is no branch to mispredict.
      points.x[n] = (static_cast<float>(u) - cx) * inverse_fx;
      points.y[n] = (static_cast<float>(v) - cy) * inverse_fy;
      points.inverse_depth[n] = mean[u];
      points.inverse_depth_variance[n] = variance[u];
      points.intensity[n] = row[u];
      points.gradient_x[n] = gx[u];
      points.gradient_y[n] = gy[u];
      const bool chosen = !every_other | (((u ^ v) & 1) == 0);
      const bool keep = chosen & (mean[u] > 0.0F) & (gx[u] * gx[u] + gy[u] * gy[u] >= min_squared);
      n += keep ? 1U : 0U;
    }
  }
  points.count = static_cast<int>(n);
  const auto padded = static_cast<std::size_t>(paddedToLanes(points.count));
  for (; n < padded; ++n) {
    points.x[n] = kOutOfView;
    points.y[n] = points.gradient_x[n] = points.gradient_y[n] = points.intensity[n] = 0.0F;
    points.inverse_depth[n] = points.inverse_depth_variance[n] = 1.0F;
  }
}

/// Moves points from the camera of their own row to the camera of the middle row.
RGBD_SFM_FUSION_MULTIVERSION
void moveToMiddleRow(const float* __restrict twist, float fy, float cy, float height, int count,
                     float* __restrict x, float* __restrict y, float* __restrict inverse_depth,
                     float* __restrict variance) {
  for (int i = 0; i < count; ++i) {
    const float s = (fy * y[i] + cy + 0.5F) / height - 0.5F, rho = inverse_depth[i];
    const float qx = x[i] - s * (twist[4] - twist[5] * y[i] + rho * twist[0]);
    const float qy = y[i] - s * (twist[5] * x[i] - twist[3] + rho * twist[1]);
    const float inverse_z = 1.0F / (1.0F - s * (twist[3] * y[i] - twist[4] * x[i] + rho * twist[2]));
    x[i] = qx * inverse_z;
    y[i] = qy * inverse_z;
    inverse_depth[i] = rho * inverse_z;
    variance[i] *= inverse_z * inverse_z;
  }
}

void moveToMiddleRow(const ReadoutMotion& motion, ReferencePoints& points) {
  if (motion.twist.isZero(0.0)) return;
  const Eigen::Matrix<float, 6, 1> twist = motion.twist.cast<float>();
  moveToMiddleRow(twist.data(), static_cast<float>(points.camera.fy), static_cast<float>(points.camera.cy),
                  static_cast<float>(points.camera.height), points.count, points.x.data(), points.y.data(),
                  points.inverse_depth.data(), points.inverse_depth_variance.data());
}

}  // namespace

void TrackingReference::setKeyframe(const ImagePyramid& pyramid, const std::vector<PinholeCamera>& cameras) {
  const auto levels = static_cast<std::size_t>(pyramid.levels());
  intensity_.resize(levels);
  gradient_.resize(levels);
  seen_.resize(levels);
  depth_.resize(levels);
  points_.resize(levels);
  for (std::size_t l = 0; l < levels; ++l) {
    pyramid[static_cast<int>(l)].copyTo(intensity_[l]);
    gradient_[l].compute(intensity_[l]);
    seen_[l] = pyramid.seen(static_cast<int>(l));
    points_[l].camera = cameras[l];
  }
}

void TrackingReference::setDepth(const InverseDepthImage& depth, const ReadoutMotion& motion,
                                 float min_gradient, int finest) {
  const InverseDepthImage* finer = &depth;
  for (std::size_t l = 0; l < points_.size(); ++l) {
    if (l > 0) {
      halve(*finer, depth_[l]);
      finer = &depth_[l];
    }
    // Neighbours see the same edge. So on the finest level, half of them do as well, like the black squares
    // of a chess board.
    const int level = static_cast<int>(l);
    if (level < finest) continue;
    collect(*finer, intensity_[l], gradient_[l], seen_[l], min_gradient, level == finest, points_[l]);
    moveToMiddleRow(motion, points_[l]);
  }
}

TrackingReference TrackingReference::pointsOnly() const {
  TrackingReference result;
  for (const ReferencePoints& points : points_) {
    // The arrays have room for a point at every pixel.
    const auto used = static_cast<std::ptrdiff_t>(paddedToLanes(points.count));
    const auto part = [used](const std::vector<float>& array) {
      return array.empty() ? array : std::vector<float>(array.begin(), array.begin() + used);
    };
    result.points_.push_back({points.camera, points.count, part(points.x), part(points.y),
                              part(points.inverse_depth), part(points.inverse_depth_variance),
                              part(points.intensity), part(points.gradient_x), part(points.gradient_y)});
  }
  return result;
}

}  // namespace rgbd_sfm_fusion
