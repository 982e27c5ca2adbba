// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/inlier_probability.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "rgbd_sfm_fusion/find_byte.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr float kStep = 0.05F;            // of depth, between two surfaces
constexpr int kRadius = 2;                // [px] of the surroundings in which neighbours agree
constexpr float kEnoughAgreeing = 10.0F;  // fewer have not averaged as much of the noise away
constexpr float kFloor = 0.01F;           // [Z] of sigma: where nothing checks it, no depth is better known
constexpr int kRim = 3;     // [px] from its surface's end, a pixel may be on the wrong side of an edge
constexpr int kReach = 12;  // [px] of a gap between the surface and the one behind it
constexpr double kAloneOutlier = 0.2, kEdgeOutlier = 0.05;  // see inlierProbability()
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

bool sameSurface(float a, float b) {
  return std::max(a, b) < (1.0F + kStep) * std::min(a, b);  // false where a is NaN
}

bool isBehind(float a, float b) {
  return a > (1.0F + kStep) * b;
}

/// Looks around pixels of a depth image.
class Scout {
 public:
  explicit Scout(const DepthImage& depth) : depth_(depth) {}

  Evidence at(const cv::Point& pixel) const {
    Evidence result;
    result.agreeing = agreeing(pixel);
    for (const cv::Point& step : {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)})
      result.farther = std::max(result.farther, behind(pixel, step));
    return result;
  }

 private:
  int agreeing(const cv::Point& pixel) const {
    const float z = depth_(pixel);
    int count = -1;  // the pixel itself
    for (int y = std::max(pixel.y - kRadius, 0); y <= std::min(pixel.y + kRadius, depth_.rows - 1); ++y) {
      const float* row = depth_[y];
      for (int x = std::max(pixel.x - kRadius, 0); x <= std::min(pixel.x + kRadius, depth_.cols - 1); ++x)
        count += sameSurface(row[x], z) ? 1 : 0;
    }
    return count;
  }

  /// Along a row or column: to the end of the pixel's surface, and over a gap.
  float behind(cv::Point pixel, const cv::Point& step) const {
    float z = depth_(pixel);
    for (int i = 0; i < kRim; ++i) {
      pixel += step;
      if (!contains(pixel)) return 0.0F;
      const float next = depth_(pixel);
      if (sameSurface(next, z)) {
        z = next;
        continue;
      }
      for (int gap = 0; gap < kReach && contains(pixel); ++gap, pixel += step) {
        const float beyond = depth_(pixel);
        if (beyond > 0.0F) return isBehind(beyond, z) ? beyond : 0.0F;
      }
      return 0.0F;
    }
    return 0.0F;
  }

  bool contains(const cv::Point& pixel) const {
    return pixel.x >= 0 && pixel.y >= 0 && pixel.x < depth_.cols && pixel.y < depth_.rows;
  }

  const DepthImage& depth_;
};

}  // namespace

double inlierProbability(const Evidence& evidence) {
  return 1.0 - kAloneOutlier / (1 + evidence.agreeing) - (evidence.farther > 0.0F ? kEdgeOutlier : 0.0);
}

void judgeSfmOnly(double min_probability, double max_relative_sigma, GaussianFusion& fusion) {
  constexpr auto kSfm = static_cast<std::uint8_t>(Provenance::kSfm);
  const auto max_relative_variance = static_cast<float>(max_relative_sigma * max_relative_sigma);
  const Scout scout(fusion.depth.mean);
  std::vector<cv::Point> dropped;  // afterwards, so that none is judged by another's being dropped
  const int width = fusion.provenance.cols;
  for (int y = 0; y < fusion.provenance.rows; ++y) {
    const std::uint8_t *provenance = fusion.provenance[y], *disagreement = fusion.disagreement[y];
    for (int x = findByte(kSfm, provenance, 0, width); x < width;
         x = findByte(kSfm, provenance, x + 1, width)) {
      if (disagreement[x] != 0) continue;
      const Evidence evidence = scout.at({x, y});
      const float z = fusion.depth.mean(y, x), step = evidence.farther > 0.0F ? evidence.farther - z : 0.0F;
      float& variance = fusion.depth.variance(y, x);
      variance *= std::max(1.0F, kEnoughAgreeing / static_cast<float>(std::max(evidence.agreeing, 1)));
      variance += static_cast<float>(kEdgeOutlier) * step * step + kFloor * kFloor * z * z;
      if (inlierProbability(evidence) < min_probability || variance > max_relative_variance * z * z)
        dropped.emplace_back(x, y);
    }
  }
  for (const cv::Point& pixel : dropped) {
    fusion.depth.mean(pixel) = fusion.depth.variance(pixel) = kNone;
    fusion.provenance(pixel) = static_cast<std::uint8_t>(Provenance::kNone);
  }
  fusion.counts.sfm_only -= dropped.size();
}

}  // namespace rgbd_sfm_fusion
