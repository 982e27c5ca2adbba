// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/sensor/skew_compensation.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "rgbd_sfm_fusion/geometry/depth_warp.h"
#include "rgbd_sfm_fusion/geometry/row_points.h"
#include "rgbd_sfm_fusion/multiversion.h"
#include "rgbd_sfm_fusion/sensor/lateral_variance.h"

namespace rgbd_sfm_fusion {
namespace {

/// For empty pixels of a row: depth of the nearest surface that has two neighbours on opposite sides of the
/// pixel; else NaN.
RGBD_SFM_FUSION_MULTIVERSION
void surfacesAroundRow(const float* row, std::ptrdiff_t stride, int width, float* __restrict surfaces) {
  for (int x = 1; x + 1 < width; ++x) {
    float nearest = kNoDepth;
    const auto look = [&](std::ptrdiff_t side) {
      const float a = row[x - side], b = row[x + side], mean = 0.5f * (a + b), difference = a - b;
      const float step = difference < 0.0f ? -difference : difference;
      nearest = ((step <= kStepRatio * mean) & !(nearest <= mean)) ? mean : nearest;
    };
    look(1);
    look(stride);
    look(stride + 1);
    look(stride - 1);
    surfaces[x] = row[x] > 0.0f ? kNoDepth : nearest;
  }
}

bool sameSurface(float a, float b) {
  return std::abs(a - b) <= kStepRatio * a;
}

void splatNearest(const DepthImage& depth, const DepthWarp& warp, DepthImage* target) {
  const auto width = static_cast<std::size_t>(depth.cols);
  std::vector<int> pixels(width);
  std::vector<float> z(width);
  for (int y = 0; y < depth.rows; ++y) {
    warp.row(y, depth[y], pixels.data(), z.data());
    for (std::size_t x = 0; x < width; ++x) {
      if (pixels[x] < 0) continue;
      float& there = (*target)[0][pixels[x]];
      if (!(there <= z[x])) there = z[x];
    }
  }
}

/// The source's depth for an empty pixel (x, y), on the surface at depth `beside`, which is the depth of the
/// pixel's neighbours. NaN if the source has no depth on this surface.
float crackDepth(const DepthImage& source, const DepthWarp& to_target, const DepthWarp& to_source, int x,
                 int y, float beside) {
  const DepthWarp::Point origin = to_source(x, y, beside);
  if (origin.u == -1.0f) return kNoDepth;
  const int x_source = static_cast<int>(origin.u + 0.5f), y_source = static_cast<int>(origin.v + 0.5f);
  const float depth = to_target(x_source, y_source, source(y_source, x_source)).z;
  return sameSurface(beside, depth) ? depth : kNoDepth;
}

void closeCracks(const DepthImage& source, const DepthWarp& to_target, const DepthWarp& to_source,
                 DepthImage* target) {
  std::vector<std::pair<cv::Point, float>> cracks;  // filled afterwards: no crack is filled from another
  std::vector<float> surfaces(static_cast<std::size_t>(target->cols), kNoDepth);
  RowPoints empty(target->cols);
  for (int y = 1; y + 1 < target->rows; ++y) {
    surfacesAroundRow((*target)[y], target->cols, target->cols, surfaces.data());
    empty.gather(surfaces.data());
    for (std::size_t i = 0; i < empty.count; ++i) {
      const int x = empty.columns[i];
      const float depth = crackDepth(source, to_target, to_source, x, y, empty.values[i]);
      if (!std::isnan(depth)) cracks.emplace_back(cv::Point(x, y), depth);
    }
  }
  for (const auto& [pixel, depth] : cracks) (*target)(pixel) = depth;
}

RGBD_SFM_FUSION_MULTIVERSION
void keepHolesRow(const float* measured, int width, float* __restrict moved) {
  for (int x = 0; x < width; ++x) moved[x] = measured[x] > 0.0f ? moved[x] : kNoDepth;
}

}  // namespace

SE3 motionSinceDepth(const StampedPose& previous, const StampedPose& current, Stamp depth_stamp) {
  const Stamp between_frames = current.stamp - previous.stamp;
  const Stamp since_depth = current.stamp - depth_stamp;
  const bool known = previous.stamp != kNoStamp && between_frames > 0 &&
                     toSeconds(between_frames) <= kLongestMotion &&
                     std::abs(toSeconds(since_depth)) <= kLongestMotion;
  if (!known || since_depth == 0) return {};
  const Vector6 step = (current.T_first_camera.inverse() * previous.T_first_camera).log();
  return SE3::exp(step * (toSeconds(since_depth) / toSeconds(between_frames)));
}

DepthImage compensateSkew(const DepthImage& depth, const PinholeCamera& camera, const SE3& T_colour_depth,
                          DepthImage buffer) {
  if (isIdentity(T_colour_depth)) return depth;
  const DepthWarp to_target(camera, T_colour_depth), to_source(camera, T_colour_depth.inverse());
  DepthImage target = buffer.isContinuous() ? std::move(buffer) : DepthImage();
  target.create(depth.size());
  std::fill_n(target[0], target.total(), kNoDepth);
  splatNearest(depth, to_target, &target);
  closeCracks(depth, to_target, to_source, &target);
  return target;
}

void keepHoles(const DepthImage& measured, DepthImage& moved) {
  for (int y = 0; y < moved.rows; ++y) keepHolesRow(measured[y], moved.cols, moved[y]);
}

}  // namespace rgbd_sfm_fusion
