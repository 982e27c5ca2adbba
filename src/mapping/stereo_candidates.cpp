// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/stereo_candidates.h"

#include <algorithm>

#include "rgbd_sfm_fusion/geometry/row_points.h"
#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

/// Central differences of a row, and marks where they are large enough.
struct RowGradient {
  explicit RowGradient(int width)
      : x(static_cast<std::size_t>(width)), y(x.size()), marks(x.size()), marked(width) {}

  std::vector<float> x, y, marks;  // marks are 0 before the first column and behind the last one
  RowPoints marked;
};

RGBD_SFM_FUSION_MULTIVERSION
void differentiate(const float* __restrict above, const float* __restrict row, const float* __restrict below,
                   int first, int end, float min_squared, float* __restrict x, float* __restrict y,
                   float* __restrict marks) {
  for (int u = first; u < end; ++u) {
    const float gx = 0.5F * (row[u + 1] - row[u - 1]), gy = 0.5F * (below[u] - above[u]);
    x[u] = gx, y[u] = gy;
    marks[u] = gx * gx + gy * gy >= min_squared ? 1.0F : 0.0F;
  }
}

}  // namespace

void StereoCandidates::collect(const cv::Mat_<float>& image, const cv::Rect& seen, float min_gradient) {
  const int width = image.cols, height = image.rows;
  RowGradient gradient(width);
  bands_.resize(static_cast<std::size_t>((height + RowBands::kRows - 1) / RowBands::kRows));
  RowBands::all().forEach(height, [&](int first, int end) {
    Writer writer(bands_[static_cast<std::size_t>(first / RowBands::kRows)],
                  static_cast<std::size_t>((end - first) * width));
    for (int row = std::max(first, seen.y + kBorder); row < std::min(end, seen.br().y - kBorder); ++row) {
      differentiate(image[row - 1], image[row], image[row + 1], seen.x + kBorder, seen.br().x - kBorder,
                    min_gradient * min_gradient, gradient.x.data(), gradient.y.data(), gradient.marks.data());
      gradient.marked.gather(gradient.marks.data());
      const auto v = static_cast<float>(row);
      for (std::size_t i = 0; i < gradient.marked.count; ++i) {
        const int column = gradient.marked.columns[i];
        const auto at = static_cast<std::size_t>(column);
        writer.put(static_cast<float>(column), v, gradient.x[at], gradient.y[at], row * width + column);
        writer.keepIf(true);
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
