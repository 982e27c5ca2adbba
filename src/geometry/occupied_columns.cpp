// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/geometry/occupied_columns.h"

#include <algorithm>
#include <cstring>

#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

RGBD_SFM_FUSION_MULTIVERSION
void markValues(const float* row, int width, std::uint8_t* __restrict marks) {
  for (int x = 0; x < width; ++x) marks[x] = row[x] > 0.0f ? 1 : 0;
}

/// Whether one of kLanes marks is set.
bool hasMark(const std::uint8_t* marks) {
  std::uint64_t words[2];
  static_assert(sizeof(words) == kLanes, "a block of marks");
  std::memcpy(words, marks, sizeof(words));
  return (words[0] | words[1]) != 0;
}

}  // namespace

OccupiedColumns::OccupiedColumns(const DepthImage& image)
    : image_(image),
      blocks_(paddedToLanes(image.cols) / kLanes),
      values_(static_cast<std::size_t>(kLanes * blocks_ + 2), std::uint8_t{0}),
      marks_(static_cast<std::size_t>(blocks_ * (image.rows + 2)), std::uint8_t{0}) {}

void OccupiedColumns::markUpTo(int row) {
  for (; marked_ <= row; ++marked_) {
    std::uint8_t *const values = values_.data() + 1, *const marks = marks_.data() + (marked_ + 1) * blocks_;
    markValues(image_[marked_], image_.cols, values);
    for (int block = 0; block < blocks_; ++block) {
      const std::uint8_t* const first = values + kLanes * block;
      marks[block] = hasMark(first) || first[-1] != 0 || first[kLanes] != 0 ? 1 : 0;
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
