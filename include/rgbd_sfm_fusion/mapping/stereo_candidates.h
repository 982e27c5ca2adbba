// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "rgbd_sfm_fusion/mapping/row_bands.h"
#include "rgbd_sfm_fusion/simd.h"
#include "rgbd_sfm_fusion/tracking/image_pyramid.h"

namespace rgbd_sfm_fusion {

/// Keyframe pixels with enough gradient for stereo, in blocks of one array per quantity. A block's pixels are
/// of one band of rows. A band's last block is filled up with copies of its last pixel that have no gradient.
class StereoCandidates {
 public:
  struct Block {
    Block() {}  // not zeroed: all of it is written

    float u[kLanes], v[kLanes];                    ///< [px]
    float gradient_x[kLanes], gradient_y[kLanes];  ///< [grey levels / px]
    int pixel[kLanes];                             ///< v * width + u
  };

  /// @param seen  part of the image that the camera has seen
  void collect(const ImageGradient& gradient, const cv::Rect& seen, float min_gradient);

  /// Collects the candidates of `all` that have no estimate.
  void collectWithout(const StereoCandidates& all, const cv::Mat_<std::uint8_t>& observations);

  int count() const { return count_; }
  const std::vector<Block>& blocks() const { return blocks_; }
  std::size_t bands() const { return ends_.size(); }
  std::size_t begin(std::size_t band) const { return band == 0 ? 0 : ends_[band - 1]; }  ///< its first block
  std::size_t end(std::size_t band) const { return ends_[band]; }

 private:
  std::size_t endOfBand(std::size_t next);

  std::vector<Block> blocks_;
  std::vector<std::size_t> ends_;  // per band, the block behind its last
  int count_ = 0;                  // without copies
};

}  // namespace rgbd_sfm_fusion
