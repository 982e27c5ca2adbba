// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/stereo_candidates.h"

#include <algorithm>

namespace rgbd_sfm_fusion {
namespace {

constexpr int kBorder = 7;  // [px] of the keyframe: room for a stretched pattern

}  // namespace

void StereoCandidates::collect(const ImageGradient& gradient, const cv::Rect& seen, float min_gradient) {
  const int width = gradient.x.cols;
  ends_.clear();
  count_ = 0;
  std::size_t next = 0;  // lane to fill, over all blocks
  RowBands().forEach(gradient.x.rows, [&](int first, int end) {
    blocks_.resize((next + static_cast<std::size_t>((end - first) * width)) / kLanes + 1);
    const std::size_t start = next;
    for (int row = std::max(first, seen.y + kBorder); row < std::min(end, seen.br().y - kBorder); ++row) {
      const float *gx = gradient.x[row], *gy = gradient.y[row];
      for (int column = seen.x + kBorder; column < seen.br().x - kBorder; ++column) {
        // Values are written at every pixel and kept only at some: there is no branch to mispredict.
        Block& block = blocks_[next / kLanes];
        const std::size_t lane = next % kLanes;
        block.u[lane] = static_cast<float>(column);
        block.v[lane] = static_cast<float>(row);
        block.gradient_x[lane] = gx[column];
        block.gradient_y[lane] = gy[column];
        block.pixel[lane] = row * width + column;
        next += gx[column] * gx[column] + gy[column] * gy[column] >= min_gradient * min_gradient ? 1 : 0;
      }
    }
    count_ += static_cast<int>(next - start);
    next = endOfBand(next);
  });
  blocks_.resize(next / kLanes);
}

void StereoCandidates::collectWithout(const StereoCandidates& all,
                                      const cv::Mat_<std::uint8_t>& observations) {
  ends_.clear();
  count_ = 0;
  blocks_.resize(all.blocks_.size());
  std::size_t next = 0;
  for (std::size_t band = 0; band < all.bands(); ++band) {
    const std::size_t start = next;
    for (std::size_t i = kLanes * all.begin(band); i < kLanes * all.end(band); ++i) {
      const Block& from = all.blocks_[i / kLanes];
      const std::size_t lane = i % kLanes, there = next % kLanes;
      if (observations[0][from.pixel[lane]] != 0) continue;
      Block& to = blocks_[next / kLanes];
      to.u[there] = from.u[lane], to.v[there] = from.v[lane];
      to.gradient_x[there] = from.gradient_x[lane], to.gradient_y[there] = from.gradient_y[lane];
      to.pixel[there] = from.pixel[lane];
      ++next;
    }
    count_ += static_cast<int>(next - start);
    next = endOfBand(next);
  }
  blocks_.resize(next / kLanes);
}

/// Fills up a band's last block. @return the lane behind the block
std::size_t StereoCandidates::endOfBand(std::size_t next) {
  for (; next % kLanes != 0; ++next) {
    Block& block = blocks_[next / kLanes];
    const std::size_t lane = next % kLanes, last = lane - 1;
    block.u[lane] = block.u[last], block.v[lane] = block.v[last];
    block.gradient_x[lane] = block.gradient_y[lane] = 0.0F;
    block.pixel[lane] = block.pixel[last];
  }
  ends_.push_back(next / kLanes);
  return next;
}

}  // namespace rgbd_sfm_fusion
