// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/tracking_reference.h"

#include <algorithm>
#include <array>
#include <utility>

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

void halve(const InverseDepthImage& fine, int first, int end, InverseDepthImage& coarse) {
  for (int v = first; v < end; ++v) {
    halveRow(fine.mean[2 * v], fine.mean[2 * v + 1], fine.variance[2 * v], fine.variance[2 * v + 1],
             coarse.mean[v], coarse.variance[v], coarse.mean.cols);
  }
}

constexpr std::array kArrays = {&ReferencePoints::x,
                                &ReferencePoints::y,
                                &ReferencePoints::inverse_depth,
                                &ReferencePoints::inverse_depth_variance,
                                &ReferencePoints::intensity,
                                &ReferencePoints::gradient_x,
                                &ReferencePoints::gradient_y};

/// What the points of a level are collected from.
struct Level {
  const InverseDepthImage& depth;
  const cv::Mat_<float>& intensity;
  const ImageGradient& gradient;
  cv::Rect seen;
  float min_gradient;
  int step;  // of how many pixels one is taken
};

/// Collects the points of some rows behind the points that are there.
void collectRows(const Level& level, int first, int end, ReferencePoints& points) {
  const auto inverse_fx = static_cast<float>(1.0 / points.camera.fx);
  const auto inverse_fy = static_cast<float>(1.0 / points.camera.fy);
  const auto cx = static_cast<float>(points.camera.cx), cy = static_cast<float>(points.camera.cy);
  const float min_squared = level.min_gradient * level.min_gradient;
  const cv::Rect& seen = level.seen;
  auto n = static_cast<std::size_t>(points.count);
  for (int v = std::max(first, seen.y + 1); v < std::min(end, seen.br().y - 1); ++v) {
    const float *mean = level.depth.mean[v], *variance = level.depth.variance[v], *row = level.intensity[v];
    const float *gx = level.gradient.x[v], *gy = level.gradient.y[v];
    for (int u = seen.x + 1; u + 1 < seen.br().x; ++u) {
      // Values are written at every pixel and kept only at some: there is no branch to mispredict.
      points.x[n] = (static_cast<float>(u) - cx) * inverse_fx;
      points.y[n] = (static_cast<float>(v) - cy) * inverse_fy;
      points.inverse_depth[n] = mean[u];
      points.inverse_depth_variance[n] = variance[u];
      points.intensity[n] = row[u];
      points.gradient_x[n] = gx[u];
      points.gradient_y[n] = gy[u];
      const bool chosen = ((u + v * (level.step / 2)) & (level.step - 1)) == 0;
      const bool keep = chosen & (mean[u] > 0.0F) & (gx[u] * gx[u] + gy[u] * gy[u] >= min_squared);
      n += keep ? 1U : 0U;
    }
  }
  points.count = static_cast<int>(n);
}

/// Copies the points [first, end) behind the points that are there.
void append(const ReferencePoints& from, int first, int end, ReferencePoints& points) {
  for (const auto array : kArrays) {
    const auto begin = (from.*array).begin();
    std::copy(begin + first, begin + end, (points.*array).begin() + points.count);
  }
  points.count += end - first;
}

void pad(ReferencePoints& points) {
  const auto padded = static_cast<std::size_t>(paddedToLanes(points.count));
  for (auto n = static_cast<std::size_t>(points.count); n < padded; ++n) {
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

/// Moves the points from `first` on.
void moveToMiddleRow(const ReadoutMotion& motion, int first, ReferencePoints& points) {
  if (motion.twist.isZero(0.0) || first == points.count) return;
  const auto at = static_cast<std::size_t>(first);
  const Eigen::Matrix<float, 6, 1> twist = motion.twist.cast<float>();
  moveToMiddleRow(twist.data(), static_cast<float>(points.camera.fy), static_cast<float>(points.camera.cy),
                  static_cast<float>(points.camera.height), points.count - first, &points.x[at],
                  &points.y[at], &points.inverse_depth[at], &points.inverse_depth_variance[at]);
}

}  // namespace

void TrackingReference::setKeyframe(const ImagePyramid& pyramid, const std::vector<PinholeCamera>& cameras,
                                    int finest) {
  const auto levels = static_cast<std::size_t>(pyramid.levels());
  intensity_.resize(levels);
  gradient_.resize(levels);
  seen_.resize(levels);
  depth_.resize(levels);
  points_.resize(levels);
  before_.resize(levels);
  for (std::size_t l = 0; l < levels; ++l) {
    seen_[l] = pyramid.seen(static_cast<int>(l));
    points_[l].points.camera = before_[l].points.camera = cameras[l];
    if (static_cast<int>(l) < finest) continue;
    intensity_[l] = pyramid[static_cast<int>(l)];
    gradient_[l].compute(intensity_[l]);
    const auto capacity = static_cast<std::size_t>(paddedToLanes(static_cast<int>(intensity_[l].total())));
    for (const auto array : kArrays) {
      (points_[l].points.*array).resize(capacity);
      (before_[l].points.*array).resize(capacity);
    }
  }
}

void TrackingReference::setDepth(const InverseDepthImage& depth, const ReadoutMotion& motion,
                                 float min_gradient, int finest, const RowBands& bands) {
  const InverseDepthImage* finer = &depth;
  for (std::size_t l = 0; l < points_.size(); ++l) {
    if (l > 0) {
      InverseDepthImage& coarser = depth_[l];
      coarser.create(finer->mean.size() / 2);
      bands.forEach(depth.mean.rows, [&](int first, int end) {
        halve(*finer, first >> l, std::min(end >> l, coarser.mean.rows), coarser);
      });
      finer = &coarser;
    }
    // Neighbours see the same edge. So on fine levels, some of them do as well as all: every other one, like
    // the black squares of a chess board.
    const int level = static_cast<int>(l);
    if (level < finest) continue;
    std::swap(points_[l], before_[l]);
    PointsOfBands& now = points_[l];
    now.points.count = 0;
    now.ends.clear();
    const Level images{*finer, intensity_[l], gradient_[l], seen_[l], min_gradient, level < 2 ? 2 : 1};
    RowBands().forEach(depth.mean.rows, [&](int first, int end) {
      const std::size_t band = now.ends.size();
      if (bands.has(static_cast<int>(band))) {
        const int first_point = now.points.count;
        collectRows(images, first >> l, end >> l, now.points);
        moveToMiddleRow(motion, first_point, now.points);
      } else {
        const std::vector<int>& ends = before_[l].ends;
        append(before_[l].points, band == 0 ? 0 : ends[band - 1], ends[band], now.points);
      }
      now.ends.push_back(now.points.count);
    });
    pad(now.points);
  }
}

TrackingReference TrackingReference::pointsOnly() const {
  TrackingReference result;
  for (const PointsOfBands& level : points_) {
    const ReferencePoints& points = level.points;
    // The arrays have room for a point at every pixel.
    const auto used = static_cast<std::ptrdiff_t>(paddedToLanes(points.count));
    const auto part = [used](const std::vector<float>& array) {
      return array.empty() ? array : std::vector<float>(array.begin(), array.begin() + used);
    };
    result.points_.push_back({{points.camera, points.count, part(points.x), part(points.y),
                               part(points.inverse_depth), part(points.inverse_depth_variance),
                               part(points.intensity), part(points.gradient_x), part(points.gradient_y)},
                              {}});
  }
  return result;
}

}  // namespace rgbd_sfm_fusion
