// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/reprojection.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "rgbd_sfm_fusion/geometry/depth_warp.h"
#include "rgbd_sfm_fusion/multiversion.h"
#include "rgbd_sfm_fusion/sensor/lateral_variance.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

struct Estimate {
  float z, variance;
};

/// Of one surface, as far as the variances can tell. False where there is no depth.
inline bool sameSurface(const Estimate& a, const Estimate& b, float sigmas_squared) {
  const float difference = a.z - b.z;
  return difference * difference <= sigmas_squared * (a.variance + b.variance);
}

/// In σ of inverse depth: σ of depth would favour the points whose error made them near.
inline bool isMoreCertain(const Estimate& a, const Estimate& b) {
  const float a2 = a.z * a.z, b2 = b.z * b.z;
  return a.variance * b2 * b2 < b.variance * a2 * a2;
}

void splatNearest(const GaussianDepth& source, const DepthWarp& warp, float sigmas_squared,
                  GaussianDepth* target) {
  const auto width = static_cast<std::size_t>(warp.width());
  std::vector<int> pixels(width), columns(width);
  std::vector<float> z(width);
  float* const mean = target->mean[0];
  float* const variance = target->variance[0];
  for (int y = 0; y < warp.height(); ++y) {
    warp.row(y, source.mean[y], pixels.data(), z.data());
    std::size_t visible = 0;  // gathered without a branch that cannot be foreseen
    for (int x = 0; x < warp.width(); ++x) {
      columns[visible] = x;
      visible += pixels[static_cast<std::size_t>(x)] >= 0 ? 1u : 0u;
    }
    for (std::size_t i = 0; i < visible; ++i) {
      const auto x = static_cast<std::size_t>(columns[i]);
      const float gain = warp.depthGain(columns[i], y);
      const Estimate point{z[x], gain * gain * source.variance[y][x]};
      const int pixel = pixels[x];
      const Estimate there{mean[pixel], variance[pixel]};
      const bool wins =
          sameSurface(point, there, sigmas_squared) ? isMoreCertain(point, there) : !(there.z <= point.z);
      if (!wins) continue;
      mean[pixel] = point.z;
      variance[pixel] = point.variance;
    }
  }
}

/// Calls `visit(pixel, weight, estimate)` for the pixels around each point.
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
      for (int corner = 0; corner < 4; ++corner) {
        const cv::Point pixel(left + corner % 2, top + corner / 2);
        if (pixel.x < 0 || pixel.x >= warp.width() || pixel.y < 0 || pixel.y >= warp.height()) continue;
        const float weight = (corner % 2 == 1 ? right_share : 1.0f - right_share) *
                             (corner / 2 == 1 ? bottom_share : 1.0f - bottom_share);
        visit(pixel, weight, point);
      }
    }
  }
}

/// Weighted mean of the nearest surface's points around each pixel, where they cover at least a quarter of
/// it. The variance is their mean, too: neighbours' errors are taken as one error.
void splatBilinear(const GaussianDepth& source, const DepthWarp& warp, float sigmas_squared,
                   GaussianDepth* target) {
  constexpr float kLeastWeight = 0.1f;  // a point farther off does not hide what is at the pixel
  GaussianDepth nearest{target->mean.clone(), target->variance.clone()};
  forEachSplat(source, warp, [&](const cv::Point& pixel, float weight, const Estimate& point) {
    if (weight < kLeastWeight || nearest.mean(pixel) <= point.z) return;
    nearest.mean(pixel) = point.z;
    nearest.variance(pixel) = point.variance;
  });
  const cv::Size size = target->mean.size();
  cv::Mat_<float> weights(size, 0.0f), depths(size, 0.0f), variances(size, 0.0f);
  forEachSplat(source, warp, [&](const cv::Point& pixel, float weight, const Estimate& point) {
    const Estimate front{nearest.mean(pixel), nearest.variance(pixel)};
    if (!sameSurface(point, front, sigmas_squared)) return;
    weights(pixel) += weight;
    depths(pixel) += weight * point.z;
    variances(pixel) += weight * point.variance;
  });
  for (int y = 0; y < warp.height(); ++y) {
    for (int x = 0; x < warp.width(); ++x) {
      if (weights(y, x) < 0.25f) continue;
      target->mean(y, x) = depths(y, x) / weights(y, x);
      target->variance(y, x) = variances(y, x) / weights(y, x);
    }
  }
}

/// Depth of the surface that has the neighbours `a` and `b`, if the pixel between them has nothing or
/// something behind it, and `other` is not nearer; else `other`.
inline float nearestGap(const Estimate& a, const Estimate& b, const Estimate& pixel, float sigmas_squared,
                        float other) {
  const float behind = pixel.z - (a.z > b.z ? a.z : b.z);
  const float signed_square = behind * (behind > 0.0f ? behind : 0.0f);
  const bool covers = !(signed_square <= sigmas_squared * (pixel.variance + a.variance + b.variance));
  const float surface = 0.5f * (a.z + b.z);
  return (sameSurface(a, b, sigmas_squared) & covers & !(other <= surface)) ? surface : other;
}

/// Marks the gaps of a row with the depth of the surface that they are in; NaN elsewhere.
RGBD_SFM_FUSION_MULTIVERSION
void findGapsRow(const float* mean, const float* variance, int stride, int width, float sigmas_squared,
                 float* __restrict gap) {
  for (int x = 1; x < width - 1; ++x) {
    const Estimate pixel{mean[x], variance[x]};
    const auto at = [&](int offset) { return Estimate{mean[x + offset], variance[x + offset]}; };
    float surface = kNone;
    surface = nearestGap(at(-stride - 1), at(stride + 1), pixel, sigmas_squared, surface);
    surface = nearestGap(at(-stride + 1), at(stride - 1), pixel, sigmas_squared, surface);
    surface = nearestGap(at(-stride), at(stride), pixel, sigmas_squared, surface);
    surface = nearestGap(at(-1), at(1), pixel, sigmas_squared, surface);
    gap[x] = surface;
  }
}

/// Closes the gaps between neighbours of one surface from the source pixel that belongs there, and removes
/// what shines through them: unless it is what the source has at that very place.
class GapCloser {
 public:
  GapCloser(const GaussianDepth& source, const DepthWarp& to_target, const DepthWarp& to_source,
            float sigmas_squared)
      : source_(source), to_target_(to_target), to_source_(to_source), sigmas_squared_(sigmas_squared) {}

  void close(GaussianDepth* target) {
    const int width = target->mean.cols;
    std::vector<float> gaps(static_cast<std::size_t>(width), kNone);
    fillings_.clear();  // filled afterwards, so that none grows on another
    for (int y = 1; y + 1 < target->mean.rows; ++y) {
      findGapsRow(target->mean[y], target->variance[y], width, width, sigmas_squared_, gaps.data());
      for (int x = 1; x + 1 < width; ++x) {
        const float surface = gaps[static_cast<std::size_t>(x)];
        if (surface == surface) examine(cv::Point(x, y), surface, *target);
      }
    }
    for (const auto& [pixel, filling] : fillings_) {
      target->mean(pixel) = filling.z;
      target->variance(pixel) = filling.variance;
    }
  }

 private:
  void examine(const cv::Point& pixel, float surface, const GaussianDepth& target) {
    const DepthWarp::Point origin = to_source_(pixel.x, pixel.y, surface);
    if (origin.u == -1.0f) return;
    const cv::Point place = rounded(origin);
    const float gain = to_target_.depthGain(place.x, place.y);
    const Estimate filling{to_target_(place.x, place.y, source_.mean(place)).z,
                           gain * gain * source_.variance(place)};
    // Both neighbours have been found to be of one surface; a filling must be so with their mean.
    if (sameSurface(filling, {surface, filling.variance}, sigmas_squared_)) {
      fillings_.emplace_back(pixel, filling);
      return;
    }
    const float shining = target.mean(pixel);
    if (shining != shining) return;
    const DepthWarp::Point its_origin = to_source_(pixel.x, pixel.y, shining);
    if (rounded(its_origin) != place) fillings_.emplace_back(pixel, Estimate{kNone, kNone});
  }

  static cv::Point rounded(const DepthWarp::Point& point) {
    return {static_cast<int>(point.u + 0.5f), static_cast<int>(point.v + 0.5f)};
  }

  const GaussianDepth& source_;
  const DepthWarp& to_target_;
  const DepthWarp& to_source_;
  float sigmas_squared_;
  std::vector<std::pair<cv::Point, Estimate>> fillings_;
};

/// Variance of Z' by the pose: J Σ Jᵀ with J = ∂Z'/∂(x y z rx ry rz) = (0, 0, 1, Y', -X', 0).
struct PoseTerms {
  float zz, z_rx, z_ry, rx_rx, rx_ry, ry_ry;
};

RGBD_SFM_FUSION_MULTIVERSION
void addPoseVarianceRow(const float* mean, int width, float x_per_z_first, float x_per_z_step, float y_per_z,
                        const PoseTerms pose, float* variance) {
  for (int i = 0; i < width; ++i) {
    const float z = mean[i];
    const float x_per_z = x_per_z_first + x_per_z_step * static_cast<float>(i);
    const float linear = 2.0f * (y_per_z * pose.z_rx - x_per_z * pose.z_ry);
    const float quadratic = y_per_z * y_per_z * pose.rx_rx - 2.0f * x_per_z * y_per_z * pose.rx_ry +
                            x_per_z * x_per_z * pose.ry_ry;
    const float by_pose = pose.zz + z * (linear + z * quadratic);
    variance[i] += by_pose > 0.0f ? by_pose : 0.0f;  // rounding can make it negative
  }
}

PoseTerms poseTerms(const Matrix6& covariance) {
  const auto entry = [&](int i, int j) { return static_cast<float>(covariance(i, j)); };
  return {entry(2, 2), entry(2, 3), entry(2, 4), entry(3, 3), entry(3, 4), entry(4, 4)};
}

/// The parts of the variance that depend on where in the frame a point is seen.
void addVariance(const PinholeCamera& camera, const Matrix6& pose_covariance,
                 const ReprojectionOptions& options, GaussianDepth* depth) {
  const PoseTerms pose = poseTerms(pose_covariance);
  LateralVariance lateral(options.splat == Splat::kNearest ? options.lateral_sigma : 0.0f, camera.width);
  for (int y = 0; y < camera.height; ++y) {
    float* variance = depth->variance[y];
    if (options.pose_covariance) {
      addPoseVarianceRow(depth->mean[y], camera.width, static_cast<float>(-camera.cx / camera.fx),
                         static_cast<float>(1.0 / camera.fx), static_cast<float>((y - camera.cy) / camera.fy),
                         pose, variance);
    }
    lateral.addToRow(depth->mean, y, variance);
  }
}

}  // namespace

GaussianDepth reproject(const GaussianDepth& keyframe, const PinholeCamera& camera,
                        const SE3& T_frame_keyframe, const Matrix6& pose_covariance,
                        const ReprojectionOptions& options, GaussianDepth buffer) {
  if (isIdentity(T_frame_keyframe)) return keyframe;
  const float sigmas_squared = options.same_surface * options.same_surface;
  const DepthWarp to_frame(camera, T_frame_keyframe), to_keyframe(camera, T_frame_keyframe.inverse());
  GaussianDepth frame = std::move(buffer);
  for (cv::Mat_<float>* image : {&frame.mean, &frame.variance}) {
    image->create(camera.height, camera.width);
    std::fill_n((*image)[0], image->total(), kNone);
  }
  if (options.splat == Splat::kBilinear) {
    splatBilinear(keyframe, to_frame, sigmas_squared, &frame);
  } else {
    splatNearest(keyframe, to_frame, sigmas_squared, &frame);
  }
  if (options.close_gaps) GapCloser(keyframe, to_frame, to_keyframe, sigmas_squared).close(&frame);
  addVariance(camera, pose_covariance, options, &frame);
  return frame;
}

}  // namespace rgbd_sfm_fusion
