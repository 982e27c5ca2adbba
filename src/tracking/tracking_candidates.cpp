// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/tracking_candidates.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "rgbd_sfm_fusion/geometry/row_points.h"
#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

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

/// Marks pixels of a row whose gradient is large enough. The row is not an outermost one.
/// @param step  a power of 2: only columns whose remainder by it is `phase` are marked
RGBD_SFM_FUSION_MULTIVERSION
void markGradients(const float* __restrict above, const float* __restrict row, const float* __restrict below,
                   int first, int end, float min_squared, int step, int phase, float* __restrict marks) {
  for (int u = first; u < end; ++u) {
    const float gx = 0.5F * (row[u + 1] - row[u - 1]), gy = 0.5F * (below[u] - above[u]);
    const bool chosen = ((u & (step - 1)) == phase) & (gx * gx + gy * gy >= min_squared);
    marks[u] = chosen ? 1.0F : 0.0F;
  }
}

/// Makes room for `count` points. Arrays never shrink: their memory is used again. They grow by an eighth
/// more than asked for: resize() alone would double them, and several references are in use at a time.
void reserve(int count, ReferencePoints& points) {
  const auto padded = static_cast<std::size_t>(paddedToLanes(count));
  for (const auto array : kArrays) {
    std::vector<float>& values = points.*array;
    if (values.size() >= padded) continue;
    if (values.capacity() < padded) {
      values.clear();  // what it holds is not needed any more
      values.reserve(padded + padded / 8);
    }
    values.resize(padded);
  }
}

/// A copy without the room for more points.
ReferencePoints compactCopy(const ReferencePoints& points) {
  ReferencePoints copy;
  copy.camera = points.camera;
  copy.count = points.count;
  copy.ends = points.ends;
  for (const auto array : kArrays) {
    const auto begin = (points.*array).begin();
    (copy.*array).assign(begin, begin + paddedToLanes(points.count));
  }
  return copy;
}

/// Appends the points [first, end).
void append(const ReferencePoints& from, int first, int end, ReferencePoints& points) {
  for (const auto array : kArrays) {
    const auto begin = (from.*array).begin();
    std::copy(begin + first, begin + end, (points.*array).begin() + points.count);
  }
  points.count += end - first;
}

/// Alignment computes the lanes of the last block that have no point, and does not count them.
void pad(ReferencePoints& points) {
  const auto padded = static_cast<std::size_t>(paddedToLanes(points.count));
  for (auto n = static_cast<std::size_t>(points.count); n < padded; ++n) {
    points.x[n] = points.y[n] = points.gradient_x[n] = points.gradient_y[n] = points.intensity[n] = 0.0F;
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

float GradientLimit::onLevel(int level) const {
  // A gradient that is noise moves with the frame's noise, not with the scene, and counts in the pose's
  // information like any other.
  return std::max(least, kLargestByChance * static_cast<float>(noise * gradientOfNoise(level)));
}

void TrackingCandidates::setKeyframe(const ImagePyramid& pyramid, const std::vector<PinholeCamera>& cameras,
                                     const GradientLimit& limit, int finest) {
  finest_ = finest;
  levels_.resize(static_cast<std::size_t>(pyramid.levels()));
  depth_.resize(levels_.size());
  for (int l = 0; l < pyramid.levels(); ++l) {
    Level& level = levels_[static_cast<std::size_t>(l)];
    level.camera = cameras[static_cast<std::size_t>(l)];
    // Neighbours see the same edge. So on fine levels, some of them do as well as all: every other one, like
    // the black squares of a chess board. With all of them, poses and maps are no better. With a half of
    // these on the finest level, tracking and mapping cost a tenth less, but far depth in the corridor is
    // nearer by 0.7 %, and the ATE of freiburg1_xyz is 9.8 instead of 8.2 mm, as the mean of four starts.
    if (l < finest) continue;
    std::vector<cv::Range> rows;
    RowBands::all().forEach(pyramid[0].rows,
                            [&](int first, int end) { rows.emplace_back(first >> l, end >> l); });
    find(pyramid[l], pyramid.seen(l), limit.onLevel(l), l < 2 ? 2 : 1, rows, level);
  }
}

/// @param step  so many pixels of a row have one candidate at most
/// @param rows  of this level, for each band
void TrackingCandidates::find(const cv::Mat_<float>& image, const cv::Rect& seen, float min_gradient,
                              int step, const std::vector<cv::Range>& rows, Level& level) {
  const auto inverse_fx = static_cast<float>(1.0 / level.camera.fx);
  const auto inverse_fy = static_cast<float>(1.0 / level.camera.fy);
  const auto cx = static_cast<float>(level.camera.cx), cy = static_cast<float>(level.camera.cy);
  level.ends.clear();
  level.pixel.clear(), level.x.clear(), level.y.clear();
  level.intensity.clear(), level.gradient_x.clear(), level.gradient_y.clear();
  std::vector<float> marks(static_cast<std::size_t>(image.cols));
  RowPoints marked(image.cols);
  for (const cv::Range& band : rows) {
    for (int v = std::max(band.start, seen.y + 1); v < std::min(band.end, seen.br().y - 1); ++v) {
      const float *above = image[v - 1], *row = image[v], *below = image[v + 1];
      const int phase = (v * (step / 2)) & (step - 1);
      markGradients(above, row, below, seen.x + 1, seen.br().x - 1, min_gradient * min_gradient, step, phase,
                    marks.data());
      marked.gather(marks.data());
      const std::size_t before = level.pixel.size(), count = before + marked.count;
      level.pixel.resize(count), level.x.resize(count), level.y.resize(count);
      level.intensity.resize(count), level.gradient_x.resize(count), level.gradient_y.resize(count);
      for (std::size_t i = 0; i < marked.count; ++i) {
        const int u = marked.columns[i];
        level.pixel[before + i] = v * image.cols + u;
        level.x[before + i] = (static_cast<float>(u) - cx) * inverse_fx;
        level.y[before + i] = (static_cast<float>(v) - cy) * inverse_fy;
        level.intensity[before + i] = row[u];
        level.gradient_x[before + i] = 0.5F * (row[u + 1] - row[u - 1]);
        level.gradient_y[before + i] = 0.5F * (below[u] - above[u]);
      }
    }
    level.ends.push_back(static_cast<int>(level.pixel.size()));
  }
}

TrackingReference compactCopy(const TrackingReference& reference) {
  TrackingReference copy;
  copy.independent_share = reference.independent_share;
  for (const ReferencePoints& points : reference.by_level) copy.by_level.push_back(compactCopy(points));
  return copy;
}

void TrackingCandidates::collect(const InverseDepthImage& depth, const ReadoutMotion& motion,
                                 const RowBands& bands, const TrackingReference& before,
                                 TrackingReference& result) {
  result.by_level.resize(levels_.size());
  const InverseDepthImage* finer = &depth;
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    if (l > 0) {
      InverseDepthImage& coarser = depth_[l];
      coarser.create(finer->mean.size() / 2);
      bands.forEach(depth.mean.rows, [&](int first, int end) {
        halve(*finer, first >> l, std::min(end >> l, coarser.mean.rows), coarser);
      });
      finer = &coarser;
    }
    const Level& level = levels_[l];
    ReferencePoints& points = result.by_level[l];
    points.camera = level.camera;
    points.count = 0;
    points.ends.clear();
    if (static_cast<int>(l) < finest_) continue;
    reserve(static_cast<int>(level.pixel.size()), points);
    int first = 0;
    for (std::size_t band = 0; band < level.ends.size(); ++band) {
      const int end = level.ends[band];
      if (bands.has(static_cast<int>(band))) {
        const int first_point = points.count;
        collect(level, first, end, *finer, points);
        moveToMiddleRow(motion, first_point, points);
      } else {
        const ReferencePoints& old = before.by_level[l];
        append(old, band == 0 ? 0 : old.ends[band - 1], old.ends[band], points);
      }
      points.ends.push_back(points.count);
      first = end;
    }
    pad(points);
  }
}

/// Appends those of the candidates [first, end) that have a depth.
void TrackingCandidates::collect(const Level& level, int first, int end, const InverseDepthImage& depth,
                                 ReferencePoints& points) {
  const float *mean = depth.mean[0], *variance = depth.variance[0];
  auto n = static_cast<std::size_t>(points.count);
  for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(end); ++i) {
    const int pixel = level.pixel[i];
    // Values are written for every candidate and kept only for some: there is no branch to mispredict.
    points.x[n] = level.x[i];
    points.y[n] = level.y[i];
    points.inverse_depth[n] = mean[pixel];
    points.inverse_depth_variance[n] = variance[pixel];
    points.intensity[n] = level.intensity[i];
    points.gradient_x[n] = level.gradient_x[i];
    points.gradient_y[n] = level.gradient_y[i];
    n += mean[pixel] > 0.0F ? 1U : 0U;
  }
  points.count = static_cast<int>(n);
}

}  // namespace rgbd_sfm_fusion
