// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/image_pyramid.h"

#include <opencv2/imgproc.hpp>

namespace rgbd_sfm_fusion {

namespace {

/// The pixels of the next coarser level that have all four parts in `area`.
cv::Rect halved(const cv::Rect& area) {
  const cv::Point first((area.x + 1) / 2, (area.y + 1) / 2), end(area.br() / 2);
  return {first, end};
}

}  // namespace

void ImagePyramid::build(const GreyImage& grey, int levels, cv::Rect seen) {
  grey_ = grey;
  levels_.resize(static_cast<std::size_t>(levels));
  seen_.assign(1, seen.empty() ? cv::Rect({}, grey.size()) : seen);
  while (static_cast<int>(seen_.size()) < levels) seen_.push_back(halved(seen_.back()));
  grey.convertTo(levels_[0], CV_32F);
  for (std::size_t l = 1; l < levels_.size(); ++l) {
    // If a size is odd, the last row or column has no partner.
    const cv::Mat_<float>& finer = levels_[l - 1];
    const cv::Size size(finer.cols / 2, finer.rows / 2);
    cv::resize(finer(cv::Rect(0, 0, 2 * size.width, 2 * size.height)), levels_[l], size, 0.0, 0.0,
               cv::INTER_AREA);
  }
}

void ImagePyramid::build(const GreyImage& grey, int levels, cv::Rect seen, ImagePool& pool) {
  levels_.clear();
  cv::Size size = grey.size();
  for (int l = 0; l < levels; ++l, size /= 2) levels_.push_back(pool.take<float>(size));
  build(grey, levels, seen);
}

std::vector<PinholeCamera> cameraPyramid(const PinholeCamera& camera, int levels) {
  std::vector<PinholeCamera> cameras{camera};
  while (static_cast<int>(cameras.size()) < levels) cameras.push_back(cameras.back().halved());
  return cameras;
}

void ImageGradient::compute(const cv::Mat_<float>& image) {
  x.create(image.size());
  y.create(image.size());
  x.row(0).setTo(0.0), x.row(x.rows - 1).setTo(0.0);
  y.row(0).setTo(0.0), y.row(y.rows - 1).setTo(0.0);
  for (int v = 1; v + 1 < image.rows; ++v) {
    const float *above = image[v - 1], *row = image[v], *below = image[v + 1];
    float *gx = x[v], *gy = y[v];
    gx[0] = gy[0] = gx[image.cols - 1] = gy[image.cols - 1] = 0.0F;
    for (int u = 1; u + 1 < image.cols; ++u) {
      gx[u] = 0.5F * (row[u + 1] - row[u - 1]);
      gy[u] = 0.5F * (below[u] - above[u]);
    }
  }
}

}  // namespace rgbd_sfm_fusion
