// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/image/image_pyramid.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {

namespace {

/// The pixels of the next coarser level that have all sixteen parts in `area`. Beyond the image, its
/// outermost pixels are repeated.
cv::Rect halved(const cv::Rect& area, const cv::Size& size) {
  const cv::Point first((area.x + (area.x > 0 ? 2 : 1)) / 2, (area.y + (area.y > 0 ? 2 : 1)) / 2);
  const cv::Point end((area.br().x - (area.br().x < size.width ? 1 : 0)) / 2,
                      (area.br().y - (area.br().y < size.height ? 1 : 0)) / 2);
  return {first, end};
}

/// Adds up four values with the weights 1 3 3 1.
inline float smoothed(float before, float first, float second, float after) {
  return 0.125F * (before + after) + 0.375F * (first + second);
}

RGBD_SFM_FUSION_MULTIVERSION
void smoothRows(const float* __restrict before, const float* __restrict first, const float* __restrict second,
                const float* __restrict after, int width, float* __restrict out) {
  for (int u = 0; u < width; ++u) out[u] = smoothed(before[u], first[u], second[u], after[u]);
}

RGBD_SFM_FUSION_MULTIVERSION
void halveColumns(const float* __restrict row, int width, float* __restrict out) {
  for (int u = 1; u + 1 < width; ++u)
    out[u] = smoothed(row[2 * u - 1], row[2 * u], row[2 * u + 1], row[2 * u + 2]);
}

/// Halves an image with the weights 1 3 3 1 in both directions. The mean of four pixels would let through
/// much of what is too fine for the coarse image. That comes out as false shapes, which do not move with the
/// scene and so bias the motion.
/// @param row  work space
void halve(const cv::Mat_<float>& fine, cv::Mat_<float>& coarse, std::vector<float>& row) {
  coarse.create(fine.rows / 2, fine.cols / 2);
  row.resize(static_cast<std::size_t>(fine.cols));
  for (int v = 0; v < coarse.rows; ++v) {
    smoothRows(fine[std::max(2 * v - 1, 0)], fine[2 * v], fine[2 * v + 1],
               fine[std::min(2 * v + 2, fine.rows - 1)], fine.cols, row.data());
    halveColumns(row.data(), coarse.cols, coarse[v]);
    for (const int u : {0, coarse.cols - 1}) {
      const auto at = [&](int x) { return row[static_cast<std::size_t>(std::clamp(x, 0, fine.cols - 1))]; };
      coarse(v, u) = smoothed(at(2 * u - 1), at(2 * u), at(2 * u + 1), at(2 * u + 2));
    }
  }
}

double computeGradientOfNoise(int level) {
  // Of a row of pixels: the weights in a pixel of the level.
  std::vector<double> weights{1.0};
  for (std::size_t l = 0, spacing = 1; l < static_cast<std::size_t>(level); ++l, spacing *= 2) {
    std::vector<double> next(weights.size() + 3 * spacing);
    for (std::size_t i = 0; i < weights.size(); ++i) {
      for (const auto& [part, weight] : {std::pair(0, 1.0), {1, 3.0}, {2, 3.0}, {3, 1.0}})
        next[i + static_cast<std::size_t>(part) * spacing] += weight / 8.0 * weights[i];
    }
    weights = std::move(next);
  }
  // The differences are along one axis; along the other, pixels are halved alone.
  const std::size_t reach = std::size_t{2} << level;  // between the two pixels of a difference
  double smoothed = 0.0, common = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    smoothed += weights[i] * weights[i];
    if (i >= reach) common += weights[i] * weights[i - reach];
  }
  return std::sqrt(smoothed * (smoothed - common) / 2.0);
}

}  // namespace

void ImagePyramid::build(const GreyImage& grey, int levels, cv::Rect seen) {
  grey_ = grey;
  levels_.resize(static_cast<std::size_t>(levels));
  seen_.assign(1, seen.empty() ? cv::Rect({}, grey.size()) : seen);
  grey.convertTo(levels_[0], CV_32F);
  for (std::size_t l = 1; l < levels_.size(); ++l) {
    halve(levels_[l - 1], levels_[l], row_);
    seen_.push_back(halved(seen_.back(), levels_[l - 1].size()));
  }
}

double gradientOfNoise(int level) {
  static const std::vector<double> known = [] {
    std::vector<double> levels;
    for (int l = 0; l < 8; ++l) levels.push_back(computeGradientOfNoise(l));
    return levels;
  }();
  const auto index = static_cast<std::size_t>(level);
  return index < known.size() ? known[index] : computeGradientOfNoise(level);
}

std::vector<PinholeCamera> cameraPyramid(const PinholeCamera& camera, int levels) {
  std::vector<PinholeCamera> cameras{camera};
  while (static_cast<int>(cameras.size()) < levels) cameras.push_back(cameras.back().halved());
  return cameras;
}

}  // namespace rgbd_sfm_fusion
