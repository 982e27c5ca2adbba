// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/inlier_probability.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace rgbd_sfm_fusion {
namespace {

constexpr float kStep = 0.05F;            // least step between two surfaces, relative to depth
constexpr int kRadius = 4, kSpacing = 2;  // [px] of the neighbours that may agree
constexpr int kNeighbours = (2 * kRadius / kSpacing + 1) * (2 * kRadius / kSpacing + 1) - 1;
constexpr float kWild = 0.1F;        // [Z] error above which a depth is an outlier
constexpr float kMaxSquare = 25.0F;  // [σ²] larger squares are of outliers
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
    std::array<double, kNeighbours + 1> values{};
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
  const bool inside = pixel.x >= kRadius && pixel.x < depth.cols - kRadius;
  for (int y = std::max(pixel.y - kRadius, pixel.y % kSpacing);
       y <= std::min(pixel.y + kRadius, depth.rows - 1); y += kSpacing) {
    const float* const row = depth[y] + pixel.x;
    for (int x = -kRadius; x <= kRadius; x += kSpacing) {
      const bool in_image = inside || (pixel.x + x >= 0 && pixel.x + x < depth.cols);
      count += in_image && sameSurface(row[x], z) ? 1 : 0;
    }
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
  struct Known {
    double probability;  // without a surface behind
    float factor;
  };
  std::array<Known, kNeighbours + 1> by_agreeing;
  for (int n = 0; n <= kNeighbours; ++n)
    by_agreeing[static_cast<std::size_t>(n)] = {inlierProbability({n, 0.0F}, statistics),
                                                static_cast<float>(statistics.varianceFactor(n))};
  const auto max_relative_variance =
      static_cast<float>(limits.max_relative_sigma * limits.max_relative_sigma);
  const Scout scout(fusion.depth.mean);
  std::vector<cv::Point> dropped;  // dropped at the end, so that the order of pixels does not matter
  const SfmPoints& points = fusion.points;
  for (int y = 0; y < fusion.provenance.rows; ++y) {
    for (std::size_t i = points.begin(y); i < points.end(y); ++i) {
      const int x = points.columns[i];
      if (points.sensor[i] > 0.0F || fusion.disagreement(y, x) != 0) continue;
      const Known& known = by_agreeing[static_cast<std::size_t>(agreeingNeighbours(sfm, {x, y}))];
      const float z = fusion.depth.mean(y, x);
      float& variance = fusion.depth.variance(y, x);
      variance *= known.factor;
      const auto isDropped = [&](double probability) {
        return probability < limits.min_probability || variance > max_relative_variance * z * z;
      };
      bool drop = isDropped(known.probability);  // what is around does not make it better
      if (!drop) {
        const Beside beside = scout.beside({x, y});
        const bool at_edge = beside.farther > 0.0F;
        const float step = at_edge ? beside.farther - z : 0.0F;
        const float open = kOpenOutlier[static_cast<std::size_t>(beside.open_end)] * kOpenStep * kOpenStep;
        variance += static_cast<float>(kEdgeOutlier) * step * step + (open + kFloor * kFloor) * z * z;
        drop = isDropped(known.probability - (at_edge ? kEdgeOutlier : 0.0));
      }
      if (drop) dropped.emplace_back(x, y);
    }
  }
  for (const cv::Point& pixel : dropped) {
    fusion.depth.mean(pixel) = fusion.depth.variance(pixel) = kNoDepth;
    fusion.provenance(pixel) = static_cast<std::uint8_t>(Provenance::kNone);
  }
  fusion.counts.sfm_only -= dropped.size();
}

}  // namespace rgbd_sfm_fusion
