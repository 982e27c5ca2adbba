// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/sensor/skew_compensation.h"

#include <cmath>
#include <limits>
#include <vector>

#include "rgbd_sfm_fusion/geometry/depth_warp.h"
#include "rgbd_sfm_fusion/sensor/depth_noise.h"

namespace rgbd_sfm_fusion {
namespace {

/// Beyond it a hand-held camera's velocity is not constant.
constexpr Stamp kLongestMotion = 150'000'000;  // [ns]

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// Depth at the neighbours of one surface on both sides; NaN unless there are such.
float between(float a, float b) {
  const float mean = 0.5f * (a + b);
  return std::abs(a - b) <= kStepRatio * mean ? mean : kNone;
}

bool sameSurface(float a, float b) {
  return std::abs(a - b) <= kStepRatio * a;
}

void splatNearest(const DepthImage& depth, const DepthWarp& warp, DepthImage* target) {
  const auto width = static_cast<std::size_t>(depth.cols);
  std::vector<float> u(width), v(width), z(width);
  for (int y = 0; y < depth.rows; ++y) {
    warp.row(y, depth[y], u.data(), v.data(), z.data());
    for (std::size_t x = 0; x < width; ++x) {
      if (u[x] == -1.0f) continue;
      float& there = (*target)(static_cast<int>(v[x] + 0.5f), static_cast<int>(u[x] + 0.5f));
      if (!(there <= z[x])) there = z[x];
    }
  }
}

/// What the surface of the neighbours has at an empty pixel (x, y) of the target: the source pixel that
/// belongs there is known from the depth beside.
float crackDepth(const DepthImage& source, const DepthImage& target, const DepthWarp& to_target,
                 const DepthWarp& to_source, int x, int y) {
  float beside = between(target(y, x - 1), target(y, x + 1));
  if (std::isnan(beside)) beside = between(target(y - 1, x), target(y + 1, x));
  if (std::isnan(beside)) return kNone;
  const DepthWarp::Point origin = to_source(x, y, beside);
  if (origin.u == -1.0f) return kNone;
  const int x_source = static_cast<int>(origin.u + 0.5f), y_source = static_cast<int>(origin.v + 0.5f);
  const float depth = to_target(x_source, y_source, source(y_source, x_source)).z;
  return sameSurface(beside, depth) ? depth : kNone;
}

void closeCracks(const DepthImage& source, const DepthWarp& to_target, const DepthWarp& to_source,
                 DepthImage* target) {
  std::vector<std::pair<cv::Point, float>> cracks;  // filled afterwards, so that none grows on another
  for (int y = 1; y + 1 < target->rows; ++y) {
    const float* row = (*target)[y];
    for (int x = 1; x + 1 < target->cols; ++x) {
      if (!std::isnan(row[x])) continue;
      const float depth = crackDepth(source, *target, to_target, to_source, x, y);
      if (!std::isnan(depth)) cracks.emplace_back(cv::Point(x, y), depth);
    }
  }
  for (const auto& [pixel, depth] : cracks) (*target)(pixel) = depth;
}

}  // namespace

SE3 motionSinceDepth(const StampedPose& previous, const StampedPose& current, Stamp depth_stamp) {
  const Stamp between_frames = current.stamp - previous.stamp;
  const Stamp since_depth = current.stamp - depth_stamp;
  const bool known = previous.stamp != kNoStamp && between_frames > 0 && between_frames <= kLongestMotion &&
                     std::abs(since_depth) <= kLongestMotion;
  if (!known || since_depth == 0) return {};
  const Vector6 step = (current.T_odom_camera.inverse() * previous.T_odom_camera).log();
  return SE3::exp(step * (toSeconds(since_depth) / toSeconds(between_frames)));
}

DepthImage compensateSkew(const DepthImage& depth, const PinholeCamera& camera, const SE3& T_colour_depth) {
  if (isIdentity(T_colour_depth)) return depth.clone();
  const DepthWarp to_target(camera, T_colour_depth), to_source(camera, T_colour_depth.inverse());
  DepthImage target(depth.size(), kNone);
  splatNearest(depth, to_target, &target);
  closeCracks(depth, to_target, to_source, &target);
  return target;
}

}  // namespace rgbd_sfm_fusion
