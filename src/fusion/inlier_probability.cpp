// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/inlier_probability.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "rgbd_sfm_fusion/find_byte.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr float kStep = 0.05F;            // least step between two surfaces, relative to depth
constexpr int kRadius = 4, kSpacing = 2;  // [px] of the neighbours that may agree
constexpr float kWild = 0.1F;             // [Z] error above which a depth is an outlier
constexpr float kMaxSquare = 25.0F;       // [σ²] larger squares are of outliers
constexpr double kMinVarianceFactor = 0.5;
constexpr double kMemory = 0.97;               // share of what is known that stays per frame: 30 frames
constexpr double kPriorPixels = 50.0;          // [px] weight of the prior
constexpr int kRowStep = 16, kColumnStep = 5;  // [px] between the pixels that are learned from
constexpr float kFloor = 0.005F;               // [Z] least sigma: no depth is better known without a check
constexpr int kRim = 4;     // [px] from the end of its surface: a pixel may be on the wrong side of the edge
constexpr int kReach = 12;  // [px] widest gap between a surface and the surface behind it
constexpr double kEdgeOutlier = 0.05;  // see inlierProbability()
// Probability by the distance [px] to an open end: the pixel's surface ends, and no depth is known beyond.
constexpr std::array<float, kRim + 1> kOpenOutlier = {0.0F, 0.008F, 0.006F, 0.004F, 0.002F};
constexpr float kOpenStep = 0.25F;  // [Z] from the surface to one that may be there

bool sameSurface(float a, float b) {
  return std::max(a, b) < (1.0F + kStep) * std::min(a, b);  // false where a is NaN
}

bool isBehind(float a, float b) {
  return a > (1.0F + kStep) * b;
}

/// Share of the prior's pessimism that is left with so many neighbours that agree.
double priorDecay(int agreeing) {
  static const auto table = [] {
    std::array<double, 25> values{};
    for (std::size_t n = 0; n < values.size(); ++n) values[n] = std::exp(-static_cast<double>(n) / 4.0);
    return values;
  }();
  return table[static_cast<std::size_t>(agreeing)];
}

/// The surroundings of a pixel's surface.
struct Beside {
  float farther = 0.0F;  // [m] farthest surface behind; 0 = none is seen
  int open_end = 0;      // [px] to an open end of the surface, beyond which no depth is known; 0 = none near
};

/// Looks around pixels of a depth image.
class Scout {
 public:
  explicit Scout(const DepthImage& depth) : depth_(depth) {}

  Beside beside(const cv::Point& pixel) const {
    Beside result;
    for (const cv::Point& step : {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)})
      look(pixel, step, result);
    return result;
  }

 private:
  /// Walks along a row or column, to the end of the pixel's surface, and across a gap.
  void look(cv::Point pixel, const cv::Point& step, Beside& result) const {
    float z = depth_(pixel);
    for (int distance = 1; distance <= kRim; ++distance) {
      pixel += step;
      if (!contains(pixel)) return;
      const float next = depth_(pixel);
      if (!sameSurface(next, z)) return cross(pixel, step, z, distance, result);
      z = next;
    }
  }

  void cross(cv::Point pixel, const cv::Point& step, float z, int distance, Beside& result) const {
    for (int gap = 0; gap < kReach && contains(pixel); ++gap, pixel += step) {
      const float beyond = depth_(pixel);
      if (!(beyond > 0.0F)) continue;
      if (isBehind(beyond, z)) result.farther = std::max(result.farther, beyond);
      return;
    }
    if (result.open_end == 0 || distance < result.open_end) result.open_end = distance;
  }

  bool contains(const cv::Point& pixel) const {
    return pixel.x >= 0 && pixel.y >= 0 && pixel.x < depth_.cols && pixel.y < depth_.rows;
  }

  const DepthImage& depth_;
};

}  // namespace

int agreeingNeighbours(const DepthImage& depth, const cv::Point& pixel) {
  const float z = depth(pixel);
  int count = -1;  // the pixel itself
  for (int y = pixel.y - kRadius; y <= pixel.y + kRadius; y += kSpacing) {
    if (y < 0 || y >= depth.rows) continue;
    const float* row = depth[y];
    for (int x = pixel.x - kRadius; x <= pixel.x + kRadius; x += kSpacing)
      count += x >= 0 && x < depth.cols && sameSurface(row[x], z) ? 1 : 0;
  }
  return std::max(count, 0);
}

void AgreementStatistics::observe(const GaussianDepth& sfm, const GaussianDepth& sensor, float farthest) {
  Classes frame;
  for (int y = 0; y < sfm.mean.rows; y += kRowStep) {
    const float *mean = sfm.mean[y], *depth = sensor.mean[y];
    for (int x = 0; x < sfm.mean.cols; x += kColumnStep) {
      if (!(mean[x] > 0.0F && depth[x] <= farthest)) continue;
      const float error = mean[x] - depth[x], variance = sfm.variance(y, x) + sensor.variance(y, x);
      Counts& counts = frame[static_cast<std::size_t>(agreeingNeighbours(sfm.mean, {x, y})) / kWidth];
      counts.pixels += 1.0;
      counts.outliers += std::abs(error) > kWild * depth[x] ? 1.0 : 0.0;
      counts.squares += static_cast<double>(std::min(error * error / variance, kMaxSquare));
    }
  }
  for (std::size_t i = 0; i < frame.size(); ++i) {
    if (frame[i].pixels == 0.0) continue;  // nothing new: the old counts stay
    seen_[i].pixels = kMemory * seen_[i].pixels + frame[i].pixels;
    seen_[i].outliers = kMemory * seen_[i].outliers + frame[i].outliers;
    seen_[i].squares = kMemory * seen_[i].squares + frame[i].squares;
  }
}

double AgreementStatistics::outlierShare(int agreeing) const {
  const double prior = 0.5 * priorDecay(agreeing);
  return (seen(agreeing).outliers + kPriorPixels * prior) / (seen(agreeing).pixels + kPriorPixels);
}

double AgreementStatistics::varianceFactor(int agreeing) const {
  const double prior = 1.0 + 4.0 * priorDecay(agreeing);
  return std::max(kMinVarianceFactor,
                  (seen(agreeing).squares + kPriorPixels * prior) / (seen(agreeing).pixels + kPriorPixels));
}

double inlierProbability(const SfmOnlySurroundings& surroundings, const AgreementStatistics& statistics) {
  return 1.0 - statistics.outlierShare(surroundings.agreeing) -
         (surroundings.farther > 0.0F ? kEdgeOutlier : 0.0);
}

void judgeSfmOnly(const DepthImage& sfm, const AgreementStatistics& statistics, const SfmOnlyLimits& limits,
                  GaussianFusion& fusion) {
  constexpr auto kSfm = static_cast<std::uint8_t>(Provenance::kSfm);
  const auto max_relative_variance =
      static_cast<float>(limits.max_relative_sigma * limits.max_relative_sigma);
  const Scout scout(fusion.depth.mean);
  std::vector<cv::Point> dropped;  // dropped at the end, so that the order of pixels does not matter
  const int width = fusion.provenance.cols;
  for (int y = 0; y < fusion.provenance.rows; ++y) {
    const std::uint8_t *provenance = fusion.provenance[y], *disagreement = fusion.disagreement[y];
    for (int x = findByte(kSfm, provenance, 0, width); x < width;
         x = findByte(kSfm, provenance, x + 1, width)) {
      if (disagreement[x] != 0) continue;
      const Beside beside = scout.beside({x, y});
      const SfmOnlySurroundings surroundings{agreeingNeighbours(sfm, {x, y}), beside.farther};
      const float z = fusion.depth.mean(y, x),
                  step = surroundings.farther > 0.0F ? surroundings.farther - z : 0.0F;
      const float open = kOpenOutlier[static_cast<std::size_t>(beside.open_end)] * kOpenStep * kOpenStep;
      float& variance = fusion.depth.variance(y, x);
      variance *= static_cast<float>(statistics.varianceFactor(surroundings.agreeing));
      variance += static_cast<float>(kEdgeOutlier) * step * step + (open + kFloor * kFloor) * z * z;
      if (inlierProbability(surroundings, statistics) < limits.min_probability ||
          variance > max_relative_variance * z * z)
        dropped.emplace_back(x, y);
    }
  }
  for (const cv::Point& pixel : dropped) {
    fusion.depth.mean(pixel) = fusion.depth.variance(pixel) = kNoDepth;
    fusion.provenance(pixel) = static_cast<std::uint8_t>(Provenance::kNone);
  }
  fusion.counts.sfm_only -= dropped.size();
}

}  // namespace rgbd_sfm_fusion
