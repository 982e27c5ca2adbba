// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/stereo_candidates.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kBorder = 7;  // [px] of the keyframe: room for a stretched pattern

}  // namespace

void StereoCandidates::collect(const ImageGradient& gradient, const cv::Rect& seen, float min_gradient) {
  const int width = gradient.x.cols, height = gradient.x.rows;
  blocks.resize(static_cast<std::size_t>(paddedToLanes(width * height) / kLanes));
  int n = 0;
  for (int row = seen.y + kBorder; row < seen.br().y - kBorder; ++row) {
    const float *gx = gradient.x[row], *gy = gradient.y[row];
    for (int column = seen.x + kBorder; column < seen.br().x - kBorder; ++column) {
      // Values are written at every pixel and kept only at some: there is no branch to mispredict.
      Block& block = blocks[static_cast<std::size_t>(n / kLanes)];
      const int lane = n % kLanes;
      block.u[lane] = static_cast<float>(column);
      block.v[lane] = static_cast<float>(row);
      block.gradient_x[lane] = gx[column];
      block.gradient_y[lane] = gy[column];
      block.pixel[lane] = row * width + column;
      n += gx[column] * gx[column] + gy[column] * gy[column] >= min_gradient * min_gradient ? 1 : 0;
    }
  }
  count = n;
  pad();
}

void StereoCandidates::collectWithout(const StereoCandidates& all,
                                      const cv::Mat_<std::uint8_t>& observations) {
  blocks.resize(all.blocks.size());
  count = 0;
  for (int i = 0; i < all.count; ++i) {
    if (observations[0][all.pixel(i)] != 0) continue;
    const Block& from = all.blocks[static_cast<std::size_t>(i / kLanes)];
    Block& to = blocks[static_cast<std::size_t>(count / kLanes)];
    const int lane = i % kLanes, there = count % kLanes;
    to.u[there] = from.u[lane], to.v[there] = from.v[lane];
    to.gradient_x[there] = from.gradient_x[lane], to.gradient_y[there] = from.gradient_y[lane];
    to.pixel[there] = from.pixel[lane];
    ++count;
  }
  pad();
}

void StereoCandidates::pad() {
  blocks.resize(static_cast<std::size_t>(paddedToLanes(count) / kLanes));
  for (int n = count; n < paddedToLanes(count); ++n) {
    Block& block = blocks.back();
    const int lane = n % kLanes, last = (count - 1) % kLanes;
    // At the last candidate's place: the geometry of a block is that of its middle lane.
    block.u[lane] = block.u[last], block.v[lane] = block.v[last];
    block.gradient_x[lane] = block.gradient_y[lane] = 0.0F;
    block.pixel[lane] = 0;
  }
}

}  // namespace rgbd_sfm_fusion
