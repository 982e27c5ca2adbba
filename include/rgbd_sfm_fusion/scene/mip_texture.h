// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace rgbd_sfm_fusion {

/// An RGB image together with its halvings, so that it can be sampled at any size without aliasing.
class MipTexture {
 public:
  struct Level {
    int width;           ///< [texel]
    int height;          ///< [texel]
    std::size_t offset;  ///< of its first texel in texels()
  };

  /// @param rgb CV_8UC3, at least 2 x 2
  explicit MipTexture(const cv::Mat& rgb);

  /// Largest first. Every level has at least 2 x 2 texels and covers all of the image.
  const std::vector<Level>& levels() const { return levels_; }

  /// Red in the lowest byte, then green and blue.
  const std::uint32_t* texels() const { return texels_.data(); }

 private:
  std::vector<Level> levels_;
  std::vector<std::uint32_t> texels_;
};

}  // namespace rgbd_sfm_fusion
