// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/reprojection.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "rgbd_sfm_fusion/geometry/depth_warp.h"
#include "rgbd_sfm_fusion/geometry/row_points.h"
#include "rgbd_sfm_fusion/multiversion.h"
#include "rgbd_sfm_fusion/sensor/lateral_variance.h"

namespace rgbd_sfm_fusion {
namespace {

struct Estimate {
  float z, variance;
};

/// Whether both are of one surface, as far as the variances can tell. False where there is no depth.
inline bool sameSurface(const Estimate& a, const Estimate& b, float sigmas_squared) {
  const float difference = a.z - b.z;
  return difference * difference <= sigmas_squared * (a.variance + b.variance);
}

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

void warpPoints(const DepthWarp& warp, int y, RowPoints* points) {
  warp.points(y, points->columns.data(), points->depths.data(), static_cast<int>(points->count),
              points->pixels.data(), points->z.data());
}

void splatNearest(const GaussianDepth& source, const DepthWarp& warp, float sigmas_squared,
                  GaussianDepth* target) {
  RowPoints points(warp.width());
  float* const mean = target->mean[0];
  float* const variance = target->variance[0];
  for (int y = 0; y < warp.height(); ++y) {
    points.gather(source.mean[y]);
    warpPoints(warp, y, &points);
    for (std::size_t i = 0; i < points.count; ++i) {
      const int pixel = points.pixels[i];
      if (pixel < 0) continue;
      const float gain = warp.depthGain(points.columns[i], y);
      const Estimate point{points.z[i], gain * gain * source.variance[y][points.columns[i]]};
      if (!replaces(point, {mean[pixel], variance[pixel]}, sigmas_squared)) continue;
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

/// Weighted mean of the nearest surface's points around each pixel, where these points cover at least a
/// quarter of the pixel. The variance is the mean of their variances: neighbours' errors are taken as one
/// error.
void splatBilinear(const GaussianDepth& source, const DepthWarp& warp, float sigmas_squared,
                   GaussianDepth* target) {
  constexpr float kLeastWeight = 0.1f;  // a point farther off does not hide the pixel
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

/// Depth of the surface through the neighbours `a` and `b`, if the pixel between them has no depth, or a
/// depth behind this surface, and if `other` is not nearer; else `other`.
inline float nearestGap(const Estimate& a, const Estimate& b, const Estimate& pixel, float sigmas_squared,
                        float other) {
  const float behind = pixel.z - (a.z > b.z ? a.z : b.z);
  const float signed_square = behind * (behind > 0.0f ? behind : 0.0f);
  const bool covers = !(signed_square <= sigmas_squared * (pixel.variance + a.variance + b.variance));
  const float surface = 0.5f * (a.z + b.z);
  return (sameSurface(a, b, sigmas_squared) & covers & !(other <= surface)) ? surface : other;
}

/// Marks the gaps of a row from the three rows around it, `stride` apart.
RGBD_SFM_FUSION_MULTIVERSION
void findGapsRow(const float* mean, const float* variance, int stride, int width, float sigmas_squared,
                 float* __restrict gap) {
  for (int x = 1; x < width - 1; ++x) {
    const Estimate pixel{mean[x], variance[x]};
    const auto at = [&](int offset) { return Estimate{mean[x + offset], variance[x + offset]}; };
    float surface = kNoDepth;
    surface = nearestGap(at(-stride - 1), at(stride + 1), pixel, sigmas_squared, surface);
    surface = nearestGap(at(-stride + 1), at(stride - 1), pixel, sigmas_squared, surface);
    surface = nearestGap(at(-stride), at(stride), pixel, sigmas_squared, surface);
    surface = nearestGap(at(-1), at(1), pixel, sigmas_squared, surface);
    gap[x] = surface;
  }
}

/// Closes the gaps between neighbours of one surface: a gap gets the depth of the source pixel that belongs
/// there. Depth that shines through a gap is removed, unless it comes from that very source pixel.
class GapCloser {
 public:
  GapCloser(const GaussianDepth& source, const DepthWarp& to_target, const DepthWarp& to_source,
            float sigmas_squared)
      : source_(source),
        to_target_(to_target),
        to_source_(to_source),
        sigmas_squared_(sigmas_squared),
        surface_(static_cast<std::size_t>(to_target.width()), kNoDepth),
        gaps_(to_target.width()) {}

  /// Finds the gaps of row `y`, then closes the gaps of the row before. So no gap grows from another. To be
  /// called for each row in turn.
  void advance(int y, GaussianDepth* target) {
    found_.clear();
    if (y > 0 && y + 1 < target->mean.rows) find(y, *target);
    for (const auto& [column, filling] : to_close_) {
      target->mean(y - 1, column) = filling.z;
      target->variance(y - 1, column) = filling.variance;
    }
    std::swap(found_, to_close_);
  }

 private:
  struct Filling {
    int column;
    Estimate estimate;
  };

  void find(int y, const GaussianDepth& target) {
    const int width = target.mean.cols;
    findGapsRow(target.mean[y], target.variance[y], width, width, sigmas_squared_, surface_.data());
    gaps_.gather(surface_.data());
    warpPoints(to_source_, y, &gaps_);
    keepKnown(target.mean[y]);
    for (std::size_t i = 0; i < gaps_.count; ++i) {
      const cv::Point pixel(gaps_.columns[i], y);
      const auto filling = examine(pixel, gaps_.depths[i], gaps_.pixels[i], target.mean(pixel));
      if (filling) found_.push_back({pixel.x, *filling});
    }
  }

  /// Keeps the gaps for which the source has a depth, or through which something shines. Most gaps have
  /// neither, so this loop has no branch.
  void keepKnown(const float* row) {
    const float* const source = source_.mean[0];
    std::size_t kept = 0;
    for (std::size_t i = 0; i < gaps_.count; ++i) {
      const int column = gaps_.columns[i], origin = gaps_.pixels[i];
      const bool known = (source[std::max(origin, 0)] > 0.0f) | (row[column] > 0.0f);
      gaps_.columns[kept] = column;
      gaps_.depths[kept] = gaps_.depths[i];
      gaps_.pixels[kept] = origin;
      kept += (known & (origin >= 0)) ? 1u : 0u;
    }
    gaps_.count = kept;
  }

  /// The new value of a gap on the surface at depth `surface`: a depth; no depth, if something shines
  /// through; or null for no change.
  std::optional<Estimate> examine(const cv::Point& pixel, float surface, int origin, float shining) const {
    const cv::Point place(origin % to_source_.width(), origin / to_source_.width());
    const float gain = to_target_.depthGain(place.x, place.y);
    const Estimate filling{to_target_(place.x, place.y, source_.mean[0][origin]).z,
                           gain * gain * source_.variance[0][origin]};
    // Both neighbours are of one surface. The filling must be of one surface with their mean.
    if (sameSurface(filling, {surface, filling.variance}, sigmas_squared_)) return filling;
    if (shining != shining) return std::nullopt;
    int its_origin = -1;
    float z = kNoDepth;
    to_source_.points(pixel.y, &pixel.x, &shining, 1, &its_origin, &z);
    return its_origin == origin ? std::nullopt : std::make_optional(Estimate{kNoDepth, kNoDepth});
  }

  const GaussianDepth& source_;
  const DepthWarp& to_target_;
  const DepthWarp& to_source_;
  float sigmas_squared_;
  std::vector<float> surface_;  ///< depth of the gap at each pixel of a row; NaN: no gap
  RowPoints gaps_;
  std::vector<Filling> found_, to_close_;
};

/// The image with nothing between its rows, so that a single index finds each pixel.
cv::Mat_<float> continuous(const cv::Mat_<float>& image) {
  return image.isContinuous() ? image : cv::Mat_<float>(image.clone());
}

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
    const float v = variance[i] + (by_pose > 0.0f ? by_pose : 0.0f);  // rounding can make it negative
    variance[i] = z > 0.0f ? v : kNoDepth;
  }
}

PoseTerms poseTerms(const Matrix6& covariance) {
  const auto entry = [&](int i, int j) { return static_cast<float>(covariance(i, j)); };
  return {entry(2, 2), entry(2, 3), entry(2, 4), entry(3, 3), entry(3, 4), entry(4, 4)};
}

/// Adds the parts of the variance that depend on where in the frame a point is seen. It also clears the
/// variance where there is no depth: until here, old values stand there.
class SeenVariance {
 public:
  SeenVariance(const PinholeCamera& camera, const Matrix6& pose_covariance,
               const ReprojectionOptions& options)
      : camera_(camera),
        pose_(options.pose_covariance ? poseTerms(pose_covariance) : PoseTerms{}),
        lateral_(options.splat == Splat::kNearest ? options.lateral_sigma : 0.0f, camera.width) {}

  /// @param depth  has final means in row `y` and in the rows beside it
  void addToRow(int y, GaussianDepth* depth) {
    float* variance = depth->variance[y];
    addPoseVarianceRow(depth->mean[y], camera_.width, static_cast<float>(-camera_.cx / camera_.fx),
                       static_cast<float>(1.0 / camera_.fx),
                       static_cast<float>((y - camera_.cy) / camera_.fy), pose_, variance);
    lateral_.addToRow(depth->mean, y, variance);
  }

 private:
  const PinholeCamera& camera_;
  PoseTerms pose_;
  LateralVariance lateral_;
};

}  // namespace

GaussianDepth reproject(const GaussianDepth& keyframe_depth, const PinholeCamera& camera,
                        const SE3& T_frame_keyframe, const Matrix6& pose_covariance,
                        const ReprojectionOptions& options, GaussianDepth buffer) {
  if (isIdentity(T_frame_keyframe)) return keyframe_depth;
  // Images of messages may have something between their rows.
  const GaussianDepth keyframe{continuous(keyframe_depth.mean), continuous(keyframe_depth.variance)};
  const float sigmas_squared = options.same_surface * options.same_surface;
  const DepthWarp to_frame(camera, T_frame_keyframe), to_keyframe(camera, T_frame_keyframe.inverse());
  GaussianDepth frame;
  if (buffer.mean.isContinuous() && buffer.variance.isContinuous()) frame = std::move(buffer);
  frame.mean.create(camera.height, camera.width);
  frame.variance.create(camera.height, camera.width);
  std::fill_n(frame.mean[0], frame.mean.total(), kNoDepth);
  if (options.splat == Splat::kBilinear) {
    splatBilinear(keyframe, to_frame, sigmas_squared, &frame);
  } else {
    splatNearest(keyframe, to_frame, sigmas_squared, &frame);
  }
  GapCloser gaps(keyframe, to_frame, to_keyframe, sigmas_squared);
  SeenVariance variance(camera, pose_covariance, options);
  // The gaps of later rows do not change a row so far behind, and it is still in the cache.
  constexpr int kBehind = 2;  // [rows]
  for (int y = 0; y < camera.height + kBehind; ++y) {
    if (options.close_gaps && y < camera.height) gaps.advance(y, &frame);
    if (y >= kBehind) variance.addToRow(y - kBehind, &frame);
  }
  return frame;
}

}  // namespace rgbd_sfm_fusion
