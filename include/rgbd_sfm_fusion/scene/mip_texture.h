// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace rgbd_sfm_fusion {

/// A colour as one number, so that sums of weighted colours are plain sums and products: red in the lowest 21
/// bits, green in the next, then blue. Weights must be whole numbers, not negative, with a sum of at most
/// 2^13.
using Texel = std::uint64_t;
constexpr int kTexelWeightBits = 13;
constexpr int kTexelFieldBits = 8 + kTexelWeightBits;

constexpr Texel texelOf(std::uint8_t red, std::uint8_t green, std::uint8_t blue) {
  return red | static_cast<Texel>(green) << kTexelFieldBits |
         static_cast<Texel>(blue) << (2 * kTexelFieldBits);
}

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

  const Texel* texels() const { return texels_.data(); }

 private:
  std::vector<Level> levels_;
  std::vector<Texel> texels_;
};

}  // namespace rgbd_sfm_fusion
