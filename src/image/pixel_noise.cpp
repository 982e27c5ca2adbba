// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/image/pixel_noise.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace rgbd_sfm_fusion {

double pixelNoise(const GreyImage& grey, const cv::Rect& seen) {
  constexpr int kStep =
      5;  // a part of the pixels tells as much: odd, as JPEG and Bayer patterns have even steps
  constexpr double kGain = 6.0;                        // of the differences' sigma
  constexpr double kShare = 0.1, kQuantile = 0.12566;  // of |x| of a normal x, in σ
  std::array<int, 8 * 255 + 1> counts{};
  int count = 0;
  for (int v = seen.y + 1; v + 1 < seen.br().y; v += kStep) {
    const std::uint8_t *above = grey[v - 1], *row = grey[v], *below = grey[v + 1];
    for (int u = seen.x + 1; u + 1 < seen.br().x; u += kStep) {
      if (row[u] == 0 || row[u] == 255) continue;  // too dark or too bright to have noise
      const int corners = above[u - 1] + above[u + 1] + below[u - 1] + below[u + 1];
      const int sides = above[u] + row[u - 1] + row[u + 1] + below[u];
      ++counts[static_cast<std::size_t>(std::abs(corners - 2 * sides + 4 * row[u]))];
      ++count;
    }
  }
  if (count == 0) return 0.0;
  // Differences are whole numbers, from half below to half above.
  double below = 0.0;
  for (std::size_t i = 0;; ++i) {
    const double part = counts[i], wanted = kShare * count - below;
    if (part >= wanted) {
      const double first = i == 0 ? 0.0 : static_cast<double>(i) - 0.5, width = i == 0 ? 0.5 : 1.0;
      return (first + width * wanted / part) / (kGain * kQuantile);
    }
    below += part;
  }
}

}  // namespace rgbd_sfm_fusion
