// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "rgbd_sfm_fusion/simd.h"
#include "rgbd_sfm_fusion/tracking/image_pyramid.h"

namespace rgbd_sfm_fusion {

/// Keyframe pixels with enough gradient for stereo, in blocks of one array per quantity.
struct StereoCandidates {
  struct Block {
    float u[kLanes], v[kLanes];                    ///< [px]
    float gradient_x[kLanes], gradient_y[kLanes];  ///< [grey levels / px]; 0 in the last block's padding
    int pixel[kLanes];                             ///< v * width + u
  };
  std::vector<Block> blocks;
  int count = 0;  ///< before padding

  /// @param seen  part of the image that the camera has seen
  void collect(const ImageGradient& gradient, const cv::Rect& seen, float min_gradient);

  /// Collects the candidates of `all` that have no estimate.
  void collectWithout(const StereoCandidates& all, const cv::Mat_<std::uint8_t>& observations);

  int pixel(int index) const {
    return blocks[static_cast<std::size_t>(index / kLanes)].pixel[index % kLanes];
  }

 private:
  void pad();  // the last block
};

}  // namespace rgbd_sfm_fusion
