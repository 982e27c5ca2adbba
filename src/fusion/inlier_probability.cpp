// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/inlier_probability.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr float kStep = 0.05F;            // least step between two surfaces, relative to depth
constexpr int kRadius = 4, kSpacing = 2;  // [px] of the neighbours that may agree
constexpr int kNeighbours = (2 * kRadius / kSpacing + 1) * (2 * kRadius / kSpacing + 1) - 1;
constexpr float kWild = 0.1F;                  // [Z] error above which a depth is an outlier
constexpr float kMaxSquare = 25.0F;            // [σ²] larger squares are of outliers
constexpr double kMinVarianceFactor = 0.5;     // without it, NEES25 in a hallway is 1.6 instead of 1.3
constexpr double kMemory = 0.97;               // share of what is known that stays per frame: 30 frames
constexpr double kPriorPixels = 50.0;          // [px] weight of the prior
constexpr int kRowStep = 16, kColumnStep = 5;  // [px] between the pixels that are learned from
constexpr int kRim = 4;     // [px] from the end of its surface: a pixel may be on the wrong side of the edge
constexpr int kReach = 12;  // [px] widest gap between a surface and the surface behind it
constexpr double kEdgeOutlier = 0.05;  // see inlierProbability()

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

/// Looks for surfaces behind the surface of a pixel.
class Scout {
 public:
  explicit Scout(const DepthImage& depth) : depth_(depth) {}

  /// [m] The farthest one beside; 0 = none is seen.
  float farther(const cv::Point& pixel) const {
    const float* const depth = depth_[pixel.y] + pixel.x;
    const auto row = static_cast<std::ptrdiff_t>(depth_.step1());
    return std::max({look(depth, 1, depth_.cols - 1 - pixel.x), look(depth, -1, pixel.x),
                     look(depth, row, depth_.rows - 1 - pixel.y), look(depth, -row, pixel.y)});
  }

 private:
  /// Walks along a row or column, to the end of the pixel's surface, and across a gap.
  /// @param room  [px] from the pixel to the border of the image
  static float look(const float* pixel, std::ptrdiff_t step, int room) {
    float z = *pixel;
    for (int distance = 1; distance <= std::min(kRim, room); ++distance) {
      pixel += step;
      if (!sameSurface(*pixel, z)) return beyond(pixel, step, std::min(kReach, room - distance + 1), z);
      z = *pixel;
    }
    return 0.0F;
  }

  static float beyond(const float* pixel, std::ptrdiff_t step, int reach, float z) {
    for (int gap = 0; gap < reach; ++gap, pixel += step)
      if (*pixel > 0.0F) return isBehind(*pixel, z) ? *pixel : 0.0F;
    return 0.0F;
  }

  const DepthImage& depth_;
};

RGBD_SFM_FUSION_MULTIVERSION
void markMeasuredRow(const float* variance, int width, std::uint8_t* __restrict measured) {
  for (int x = 0; x < width; ++x) measured[x] = variance[x] > 0.0f ? 1 : 0;
}

RGBD_SFM_FUSION_MULTIVERSION
void addRow(const std::uint8_t* measured, int width, std::uint8_t* __restrict near) {
  for (int x = 0; x < width; ++x) near[x] = near[x] | measured[x];
}

RGBD_SFM_FUSION_MULTIVERSION
void dropRow(const std::uint8_t* near, const std::uint8_t* measured, int width, float* __restrict mean,
             float* __restrict variance) {
  for (int x = 0; x < width; ++x) {
    const bool rim = (near[x] != 0) & (measured[x] == 0);
    mean[x] = rim ? kNoDepth : mean[x];
    variance[x] = rim ? kNoDepth : variance[x];
  }
}

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
        const float farther = scout.farther({x, y}), step = farther > 0.0F ? farther - z : 0.0F;
        variance += static_cast<float>(kEdgeOutlier) * step * step;
        drop = isDropped(known.probability - (farther > 0.0F ? kEdgeOutlier : 0.0));
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

void dropAtRims(const GaussianDepth& sensor, int width, GaussianDepth& sfm) {
  if (width == 0) return;
  const cv::Size size = sfm.mean.size();
  cv::Mat_<std::uint8_t> measured(size);
  for (int y = 0; y < size.height; ++y) markMeasuredRow(sensor.variance[y], size.width, measured[y]);
  // Nothing is measured beyond the sides of the image.
  std::vector<std::uint8_t> column(static_cast<std::size_t>(size.width + 2 * width));
  std::vector<std::uint8_t> near(static_cast<std::size_t>(size.width));
  for (int y = 0; y < size.height; ++y) {
    std::fill(column.begin(), column.end(), std::uint8_t{0});
    for (int row = std::max(y - width, 0); row <= std::min(y + width, size.height - 1); ++row)
      addRow(measured[row], size.width, column.data() + width);
    std::fill(near.begin(), near.end(), std::uint8_t{0});
    for (int x = 0; x <= 2 * width; ++x) addRow(column.data() + x, size.width, near.data());
    dropRow(near.data(), measured[y], size.width, sfm.mean[y], sfm.variance[y]);
  }
}

}  // namespace rgbd_sfm_fusion
