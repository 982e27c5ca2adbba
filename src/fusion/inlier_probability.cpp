// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/inlier_probability.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr float kStep = 0.05F;  // least step between two surfaces, relative to depth

// Priors: shares of wild matches by near neighbours, and of steps by wide ones. Given are the share without
// any neighbour that agrees, and how many neighbours bring it down to 1/e. scripts/fit_fusion prints them
// beside what is found in rendered rooms.
constexpr double kWildShare = 0.5, kWildDecay = 4.0;
constexpr double kStepShare = 0.06, kStepDecay = 3.0;
constexpr double kSquaredStep = 0.3;  // [Z²] mean square of the step to the other surface
// How many pixels the priors count for. That of the share only bridges the first frames. A step is one event,
// but about a hundred of the pixels that are learned from show it: ten along its contour, in ten frames of a
// keyframe. So the prior of steps weighs as much as ten steps. It was chosen among a few values, on
// recordings.
constexpr double kSharePixels = 50.0, kStepPixels = 1000.0;

double wildPrior(int near) {
  return kWildShare * std::exp(-near / kWildDecay);
}

double stepPrior(int wide) {
  return kStepShare * std::exp(-wide / kStepDecay);
}

constexpr float kFarther = 1.0F + kStep;

using Counts = std::array<std::uint8_t, kLanes>;

/// @param depth   [m] of kLanes pixels side by side
/// @param others  [m] of the pixels that are compared with these
RGBD_SFM_FUSION_MULTIVERSION
void addAgreeing(const float* depth, const float* others, std::uint8_t* __restrict counts) {
  for (int i = 0; i < kLanes; ++i)  // false where there is no depth
    counts[i] = static_cast<std::uint8_t>(
        counts[i] + ((others[i] < kFarther * depth[i]) & (kFarther * others[i] > depth[i])));
}

/// agreeingNeighbours() of kLanes pixels side by side. By column, no neighbour lies outside the image.
Counts agreeingNeighboursOfBlock(const DepthImage& depth, const cv::Point& first, int spacing) {
  Counts counts{};
  for (int row = -2; row <= 2; ++row) {
    const int y = first.y + row * spacing;
    if (y < 0 || y >= depth.rows) continue;
    for (int column = -2; column <= 2; ++column) {
      if (row == 0 && column == 0) continue;  // the pixel itself
      addAgreeing(depth[first.y] + first.x, depth[y] + first.x + column * spacing, counts.data());
    }
  }
  return counts;
}

/// agreementAt() of pixels in the order of a row. Blocks of them are counted at once.
class AgreementsOfRow {
 public:
  AgreementsOfRow(const DepthImage& depth, int y) : depth_(depth), y_(y) {}

  Agreement at(int x) {
    if (x >= first_ + kLanes) {
      if (x < 2 * kWideSpacing || x + kLanes + 2 * kWideSpacing > depth_.cols)
        return agreementAt(depth_, {x, y_});
      first_ = x;
      near_ = agreeingNeighboursOfBlock(depth_, {x, y_}, kNearSpacing);
      wide_ = agreeingNeighboursOfBlock(depth_, {x, y_}, kWideSpacing);
    }
    const auto i = static_cast<std::size_t>(x - first_);
    return {near_[i], wide_[i]};
  }

 private:
  const DepthImage& depth_;
  int y_, first_ = -kLanes;
  Counts near_{}, wide_{};
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

int agreeingNeighbours(const DepthImage& depth, const cv::Point& pixel, int spacing) {
  const float z = depth(pixel), farthest = kFarther * z;
  const int radius = 2 * spacing;
  const auto firstOf = [&](int centre) { return centre >= radius ? centre - radius : centre % spacing; };
  const int end_x = std::min(pixel.x + radius, depth.cols - 1),
            end_y = std::min(pixel.y + radius, depth.rows - 1);
  int count = -1;  // the pixel itself
  for (int y = firstOf(pixel.y); y <= end_y; y += spacing) {
    const float* const row = depth[y];
    for (int x = firstOf(pixel.x); x <= end_x; x += spacing)  // false where there is no depth
      count += static_cast<int>((row[x] < farthest) & (kFarther * row[x] > z));
  }
  return std::max(count, 0);
}

Agreement agreementAt(const DepthImage& depth, const cv::Point& pixel) {
  return {agreeingNeighbours(depth, pixel, kNearSpacing), agreeingNeighbours(depth, pixel, kWideSpacing)};
}

template <std::size_t kNear, std::size_t kWide>
std::size_t AgreementStatistics::Means<kNear, kWide>::classOf(const Agreement& agreement) {
  return static_cast<std::size_t>(agreement.near) / kNear * (kMostNeighbours / kWide + 1) +
         static_cast<std::size_t>(agreement.wide) / kWide;
}

template <std::size_t kNear, std::size_t kWide>
void AgreementStatistics::Means<kNear, kWide>::add(const Agreement& agreement, double value) {
  Sum& sum = frame_[classOf(agreement)];
  sum.pixels += 1.0;
  sum.value += value;
}

template <std::size_t kNear, std::size_t kWide>
void AgreementStatistics::Means<kNear, kWide>::endFrame() {
  for (std::size_t i = 0; i < frame_.size(); ++i) {
    if (frame_[i].pixels == 0.0) continue;  // nothing new: what is known stays
    before_[i].pixels = Overlap::kMemory * before_[i].pixels + frame_[i].pixels;
    before_[i].value = Overlap::kMemory * before_[i].value + frame_[i].value;
  }
  frame_ = {};
}

template <std::size_t kNear, std::size_t kWide>
double AgreementStatistics::Means<kNear, kWide>::mean(const Agreement& agreement, double prior,
                                                      double prior_pixels) const {
  const Sum& sum = before_[classOf(agreement)];
  return (sum.value + prior_pixels * prior) / (sum.pixels + prior_pixels);
}

void AgreementStatistics::observe(const SfmPoints& points, const DepthImage& sfm, float farthest,
                                  double min_probability) {
  constexpr auto kStepSquare = static_cast<float>(Overlap::kTukeyWidth * Overlap::kTukeyWidth);  // [σ²]
  const std::size_t step = points.size() / Overlap::kMaxSamples + 1;
  std::size_t i = 0;
  for (int y = 0; y < sfm.rows; ++y) {
    for (; i < points.end(y); i += step) {
      if (!(points.sensor[i] <= farthest)) continue;
      const float z = points.sfm[i], error = z - points.sensor[i];
      const float squared = error * error, variance = points.sfm_variance[i] + points.surface_variance[i];
      const Agreement agreement = agreementAt(sfm, {points.columns[i], y});
      outliers_.add(agreement, std::abs(error) > kRight * points.sensor[i] ? 1.0 : 0.0);
      if (inlierProbability(agreement) < min_probability) continue;
      const bool is_step = squared > kStepSquare * variance;
      steps_.add(agreement, is_step ? static_cast<double>(std::min(squared / (z * z), 1.0F)) : 0.0);
    }
  }
  outliers_.endFrame();
  steps_.endFrame();
}

double AgreementStatistics::inlierProbability(const Agreement& agreement) const {
  const double prior = wildPrior(agreement.near) + stepPrior(agreement.wide);
  return 1.0 - outliers_.mean(agreement, prior, kSharePixels);
}

double AgreementStatistics::stepVariance(int wide) const {
  return steps_.mean({0, wide}, kSquaredStep * stepPrior(wide), kStepPixels);
}

void judgeSfmOnly(const DepthImage& sfm, const AgreementStatistics& statistics, const SfmOnlyLimits& limits,
                  GaussianFusion& fusion) {
  struct Known {
    bool is_probable;
    float step_variance;  // [Z²]
  };
  std::array<std::array<Known, kMostNeighbours + 1>, kMostNeighbours + 1> known;
  for (int wide = 0; wide <= kMostNeighbours; ++wide) {
    const auto step_variance = static_cast<float>(statistics.stepVariance(wide));
    for (int near = 0; near <= kMostNeighbours; ++near)
      known[static_cast<std::size_t>(near)][static_cast<std::size_t>(wide)] = {
          statistics.inlierProbability({near, wide}) >= limits.min_probability, step_variance};
  }
  const auto max_relative_variance =
      static_cast<float>(limits.max_relative_sigma * limits.max_relative_sigma);
  std::size_t dropped = 0;
  const SfmPoints& points = fusion.points;
  for (int y = 0; y < fusion.provenance.rows; ++y) {
    AgreementsOfRow agreements(sfm, y);
    for (std::size_t i = points.begin(y); i < points.end(y); ++i) {
      const cv::Point pixel(points.columns[i], y);
      if (points.sensor[i] > 0.0F || fusion.disagreement(pixel) != 0) continue;
      const Agreement agreement = agreements.at(pixel.x);
      const auto [is_probable, step_variance] =
          known[static_cast<std::size_t>(agreement.near)][static_cast<std::size_t>(agreement.wide)];
      float &z = fusion.depth.mean(pixel), &variance = fusion.depth.variance(pixel);
      variance += step_variance * z * z;
      if (is_probable && variance <= max_relative_variance * z * z) continue;
      z = variance = kNoDepth;
      fusion.provenance(pixel) = static_cast<std::uint8_t>(Provenance::kNone);
      ++dropped;
    }
  }
  fusion.counts.sfm_only -= dropped;
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
