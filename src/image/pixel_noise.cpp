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
  // [σ] So little differ the tenth of normal values that differ least.
  constexpr double kQuantile = 0.125;
  const double share = std::erf(kQuantile * M_SQRT1_2);
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
    const double part = counts[i], wanted = share * count - below;
    if (part >= wanted) {
      const double first = i == 0 ? 0.0 : static_cast<double>(i) - 0.5, width = i == 0 ? 0.5 : 1.0;
      // The squares of the weights add up to 36.
      return (first + width * wanted / part) / (6.0 * kQuantile);
    }
    below += part;
  }
}

}  // namespace rgbd_sfm_fusion
