// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/stereo_candidates.h"

#include <algorithm>

namespace rgbd_sfm_fusion {

void StereoCandidates::collect(const ImageGradient& gradient, const cv::Rect& seen, float min_gradient) {
  const int width = gradient.x.cols, height = gradient.x.rows;
  bands_.resize(static_cast<std::size_t>((height + RowBands::kRows - 1) / RowBands::kRows));
  RowBands::all().forEach(height, [&](int first, int end) {
    Writer writer(bands_[static_cast<std::size_t>(first / RowBands::kRows)],
                  static_cast<std::size_t>((end - first) * width));
    for (int row = std::max(first, seen.y + kBorder); row < std::min(end, seen.br().y - kBorder); ++row) {
      const auto v = static_cast<float>(row);
      const float *gx = gradient.x[row], *gy = gradient.y[row];
      for (int column = seen.x + kBorder; column < seen.br().x - kBorder; ++column) {
        writer.put(static_cast<float>(column), v, gx[column], gy[column], row * width + column);
        writer.keepIf(gx[column] * gx[column] + gy[column] * gy[column] >= min_gradient * min_gradient);
      }
    }
    writer.finish();
  });
}

void StereoCandidates::Writer::fillUp() {
  for (; next_ % kLanes != 0; ++next_) {
    Block& block = blocks_[next_ / kLanes];
    const std::size_t last = next_ % kLanes - 1;
    put(block.u[last], block.v[last], 0.0F, 0.0F, block.pixel[last]);
  }
}

}  // namespace rgbd_sfm_fusion
