// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/geometry/occupied_columns.h"

#include <algorithm>

#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

RGBD_SFM_FUSION_MULTIVERSION
void markBlocks(const float* row, int blocks, std::uint8_t* __restrict marks) {
  for (int block = 0; block < blocks; ++block) {
    int found = 0;
    for (int i = 0; i < kLanes; ++i) found += row[kLanes * block + i] > 0.0f ? 1 : 0;
    marks[block] = found > 0 ? 1 : 0;
  }
}

}  // namespace

OccupiedColumns::OccupiedColumns(const DepthImage& image)
    : image_(image),
      blocks_(paddedToLanes(image.cols) / kLanes),
      marks_(static_cast<std::size_t>(blocks_ * (image.rows + 2)), std::uint8_t{0}) {}

void OccupiedColumns::markUpTo(int row) {
  const int whole = image_.cols / kLanes;
  for (; marked_ <= row; ++marked_) {
    const float* const values = image_[marked_];
    std::uint8_t* const marks = marks_.data() + (marked_ + 1) * blocks_;
    markBlocks(values, whole, marks);
    if (whole < blocks_) {
      marks[whole] =
          std::any_of(values + kLanes * whole, values + image_.cols, [](float value) { return value > 0.0f; })
              ? 1
              : 0;
    }
    for (int border = kLanes; border < image_.cols; border += kLanes) {
      const int after = border / kLanes;
      if (values[border - 1] > 0.0f) marks[after] = 1;
      if (values[border] > 0.0f) marks[after - 1] = 1;
    }
  }
}

const std::vector<cv::Range>& OccupiedColumns::near(int y) {
  markUpTo(std::min(y + 1, image_.rows - 1));
  ranges_.clear();
  const std::uint8_t *const above = marks_.data() + y * blocks_, *const middle = above + blocks_,
                            *const below = middle + blocks_;
  for (int block = 0; block < blocks_; ++block) {
    if ((above[block] | middle[block] | below[block]) == 0) continue;
    const int begin = kLanes * block, end = std::min(begin + kLanes, image_.cols);
    if (!ranges_.empty() && ranges_.back().end == begin) {
      ranges_.back().end = end;
    } else {
      ranges_.emplace_back(begin, end);
    }
  }
  return ranges_;
}

}  // namespace rgbd_sfm_fusion
