// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/geometry/gap_closer.h"

#include <algorithm>
#include <utility>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

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
void findGapsRow(const float* mean, const float* variance, int stride, int begin, int end,
                 float sigmas_squared, float* __restrict gap) {
  for (int x = begin; x < end; ++x) {
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

}  // namespace

void GapCloser::advance(int y, const std::vector<cv::Range>& parts, GaussianDepth* target) {
  found_.clear();
  if (y > 0 && y + 1 < target->mean.rows) find(y, parts, *target);
  for (const auto& [column, filling] : to_close_) {
    target->mean(y - 1, column) = filling.z;
    target->variance(y - 1, column) = filling.variance;
  }
  std::swap(found_, to_close_);
}

void GapCloser::find(int y, const std::vector<cv::Range>& parts, const GaussianDepth& target) {
  const int width = target.mean.cols;
  for (const cv::Range& part : parts) {
    findGapsRow(target.mean[y], target.variance[y], width, std::max(part.start, 1),
                std::min(part.end, width - 1), sigmas_squared_, surface_.data());
  }
  gaps_.gather(surface_.data(), parts);
  warpPoints(to_source_, y, &gaps_);
  keepKnown(target.mean[y]);
  for (std::size_t i = 0; i < gaps_.count; ++i) {
    const cv::Point pixel(gaps_.columns[i], y);
    const auto filling = examine(pixel, gaps_.values[i], gaps_.pixels[i], target.mean(pixel));
    if (filling) found_.push_back({pixel.x, *filling});
  }
}

void GapCloser::keepKnown(const float* row) {
  const float* const source = source_.mean[0];
  std::size_t kept = 0;
  for (std::size_t i = 0; i < gaps_.count; ++i) {
    const int column = gaps_.columns[i], origin = gaps_.pixels[i];
    const bool known = (source[std::max(origin, 0)] > 0.0f) | (row[column] > 0.0f);
    gaps_.columns[kept] = column;
    gaps_.values[kept] = gaps_.values[i];
    gaps_.pixels[kept] = origin;
    kept += (known & (origin >= 0)) ? 1u : 0u;
  }
  gaps_.count = kept;
}

std::optional<Estimate> GapCloser::examine(const cv::Point& pixel, float surface, int origin,
                                           float shining) const {
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

}  // namespace rgbd_sfm_fusion
