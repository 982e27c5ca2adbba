// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/geometry/splatting.h"

#include <algorithm>
#include <vector>

#include "rgbd_sfm_fusion/geometry/gap_closer.h"
#include "rgbd_sfm_fusion/geometry/row_points.h"

namespace rgbd_sfm_fusion {
namespace {

/// Compares σ of inverse depth. σ of depth would favour points whose error made them near.
inline bool isMoreCertain(const Estimate& a, const Estimate& b) {
  const float a2 = a.z * a.z, b2 = b.z * b.z;
  return a.variance * b2 * b2 < b.variance * a2 * a2;
}

/// Whether `point` replaces the point that is already on its pixel.
inline bool replaces(const Estimate& point, const Estimate& there, float sigmas_squared) {
  if (there.z != there.z) return true;
  return sameSurface(point, there, sigmas_squared) ? isMoreCertain(point, there) : point.z < there.z;
}

/// Empties the target's rows ahead of the points that fall into them, so that they are in the cache by then.
class Clearing {
 public:
  explicit Clearing(GaussianDepth* target) : target_(target) {}

  void upTo(const RowPoints& points) {
    int last = -1;
    for (std::size_t i = 0; i < points.count; ++i) last = std::max(last, points.pixels[i]);
    if (last >= 0) upTo(last / target_->mean.cols);
  }
  void rest() { upTo(target_->mean.rows - 1); }

 private:
  void upTo(int row) {
    for (; next_ <= row; ++next_) {
      std::fill_n(target_->mean[next_], target_->mean.cols, kNoDepth);
      std::fill_n(target_->variance[next_], target_->mean.cols, kNoDepth);
    }
  }

  GaussianDepth* target_;
  int next_ = 0;
};

/// A pixel beside a point.
struct Splatted {
  cv::Point pixel;
  float weight;     // bilinear
  bool is_nearest;  // of the pixels around the point
};

/// Calls `visit(splatted, estimate)` for the pixels around each point.
template <typename Visitor>
void forEachSplat(const GaussianDepth& source, const DepthWarp& warp, const Visitor& visit) {
  const auto width = static_cast<std::size_t>(warp.width());
  std::vector<float> u(width), v(width), z(width);
  for (int y = 0; y < warp.height(); ++y) {
    warp.row(y, source.mean[y], u.data(), v.data(), z.data());
    for (std::size_t x = 0; x < width; ++x) {
      if (u[x] == -1.0f) continue;
      const float gain = warp.depthGain(static_cast<int>(x), y);
      const Estimate point{z[x], gain * gain * source.variance[y][x]};
      const int left = static_cast<int>(u[x] + 1.0f) - 1, top = static_cast<int>(v[x] + 1.0f) - 1;
      const float right_share = u[x] - static_cast<float>(left);
      const float bottom_share = v[x] - static_cast<float>(top);
      const int nearest = (right_share > 0.5f ? 1 : 0) + (bottom_share > 0.5f ? 2 : 0);
      for (int corner = 0; corner < 4; ++corner) {
        const cv::Point pixel(left + corner % 2, top + corner / 2);
        if (pixel.x < 0 || pixel.x >= warp.width() || pixel.y < 0 || pixel.y >= warp.height()) continue;
        const float weight = (corner % 2 == 1 ? right_share : 1.0f - right_share) *
                             (corner / 2 == 1 ? bottom_share : 1.0f - bottom_share);
        visit({pixel, weight, corner == nearest}, point);
      }
    }
  }
}

}  // namespace

void splatNearest(const GaussianDepth& source, const DepthWarp& warp, float sigmas_squared,
                  GaussianDepth* target) {
  RowPoints points(warp.width());
  float *const mean = target->mean[0], *const variance = target->variance[0];
  Clearing cleared(target);
  for (int y = 0; y < warp.height(); ++y) {
    points.gather(source.mean[y]);
    warpPoints(warp, y, &points);
    cleared.upTo(points);
    const float* const variances = source.variance[y];
    for (std::size_t i = 0; i < points.count; ++i) {
      const int pixel = points.pixels[i];
      if (pixel < 0) continue;
      const float gain = warp.depthGain(points.columns[i], y);
      const Estimate point{points.z[i], gain * gain * variances[points.columns[i]]};
      if (!replaces(point, {mean[pixel], variance[pixel]}, sigmas_squared)) continue;
      mean[pixel] = point.z;
      variance[pixel] = point.variance;
    }
  }
  cleared.rest();
}

void splatBilinear(const GaussianDepth& source, const DepthWarp& warp, float sigmas_squared,
                   GaussianDepth* target) {
  target->mean.setTo(kNoDepth);
  target->variance.setTo(kNoDepth);
  GaussianDepth nearest{target->mean.clone(), target->variance.clone()};
  forEachSplat(source, warp, [&](const Splatted& at, const Estimate& point) {
    if (!at.is_nearest || nearest.mean(at.pixel) <= point.z) return;
    nearest.mean(at.pixel) = point.z;
    nearest.variance(at.pixel) = point.variance;
  });
  const cv::Size size = target->mean.size();
  cv::Mat_<float> weights(size, 0.0f), depths(size, 0.0f), variances(size, 0.0f);
  forEachSplat(source, warp, [&](const Splatted& at, const Estimate& point) {
    const Estimate front{nearest.mean(at.pixel), nearest.variance(at.pixel)};
    if (!sameSurface(point, front, sigmas_squared)) return;  // nor if no point is nearest to this pixel
    weights(at.pixel) += at.weight;
    depths(at.pixel) += at.weight * point.z;
    variances(at.pixel) += at.weight * point.variance;
  });
  for (int y = 0; y < warp.height(); ++y) {
    for (int x = 0; x < warp.width(); ++x) {
      if (weights(y, x) == 0.0f) continue;
      target->mean(y, x) = depths(y, x) / weights(y, x);
      target->variance(y, x) = variances(y, x) / weights(y, x);
    }
  }
}

}  // namespace rgbd_sfm_fusion
