// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/sfm_only.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

// [Z²] Mean square of the step to another surface. scripts/fit_fusion prints what is found in rendered rooms.
constexpr double kSquaredStep = 0.3;
// [px] Weight of each prior. A step is one event, but about fifty of the pixels that are learned from
// show it: five along its contour, in ten frames of a keyframe. So a prior weighs as much as three steps. It
// was chosen among a few values, on recordings and in rendered rooms.
constexpr double kPriorPixels = 150.0;

/// Without a neighbour that agrees, another surface is as probable as the pixel's own. By the rule of
/// succession (Laplace), n neighbours that agree bring this to 1 / (2 + n): near ones, and wide ones
/// independently.
double priorMoment(const Agreement& agreement) {
  const auto share = [](int agreeing) { return 1.0 / (1.0 + agreeing / 2.0); };
  return kSquaredStep * 0.5 * share(agreement.near) * share(agreement.wide);
}

RGBD_SFM_FUSION_MULTIVERSION
void markMeasuredRow(const float* depth, int width, std::uint8_t* __restrict measured) {
  for (int x = 0; x < width; ++x) measured[x] = depth[x] > 0.0f ? 1 : 0;
}

RGBD_SFM_FUSION_MULTIVERSION
void addRow(const std::uint8_t* measured, int width, std::uint8_t* __restrict near) {
  for (int x = 0; x < width; ++x) near[x] = near[x] | measured[x];
}

RGBD_SFM_FUSION_MULTIVERSION
void markRimRow(const std::uint8_t* near, const std::uint8_t* measured, int width,
                std::uint8_t* __restrict marked) {
  for (int x = 0; x < width; ++x) marked[x] = marked[x] | (near[x] & (measured[x] ^ std::uint8_t{1}));
}

/// Between which depths a neighbour agrees.
struct Agreeing {
  float nearest, farthest;

  explicit Agreeing(float z) : nearest(z / (1.0F + kSurfaceStep)), farthest((1.0F + kSurfaceStep) * z) {}
  /// False where there is no depth.
  bool operator()(float z) const { return (z > nearest) & (z < farthest); }
};

using Counts = std::array<std::uint8_t, kLanes>;

/// agreeingNeighbours() of kLanes pixels side by side.
/// @param depth         [m] of the first pixel; by column, no neighbour lies outside the image
/// @param above, below  numbers of rows of neighbours that lie in the image
RGBD_SFM_FUSION_MULTIVERSION
void countAgreeing(const float* depth, int stride, int spacing, int above, int below,
                   std::uint8_t* __restrict counts) {
  float nearest[kLanes], farthest[kLanes];
  int count[kLanes];
  for (int i = 0; i < kLanes; ++i) {
    const Agreeing agrees(depth[i]);
    nearest[i] = agrees.nearest, farthest[i] = agrees.farthest;
    count[i] = depth[i] > 0.0F ? -1 : 0;  // the pixel itself
  }
  for (int row = -above; row <= below; ++row) {
    const float* const first = depth + row * spacing * stride - kPerSide * spacing;
    for (int i = 0; i < kLanes; ++i) {
      int agreeing = 0;
      for (int column = 0; column <= 2 * kPerSide; ++column) {
        const float z = first[column * spacing + i];
        agreeing += ((z > nearest[i]) & (z < farthest[i])) ? 1 : 0;
      }
      count[i] += agreeing;
    }
  }
  for (int i = 0; i < kLanes; ++i) counts[i] = static_cast<std::uint8_t>(count[i]);
}

Counts agreeingNeighboursOfBlock(const DepthImage& depth, const cv::Point& first, int radius) {
  Counts counts;
  const int spacing = radius / kPerSide;
  countAgreeing(depth[first.y] + first.x, static_cast<int>(depth.step1()), spacing,
                std::min(kPerSide, first.y / spacing),
                std::min(kPerSide, (depth.rows - 1 - first.y) / spacing), counts.data());
  return counts;
}

/// agreementAt() of pixels in the order of a row. Blocks of them are counted at once.
class AgreementsOfRow {
 public:
  AgreementsOfRow(const DepthImage& depth, int y) : depth_(depth), y_(y) {}

  Agreement at(int x) {
    if (x >= first_ + kLanes) {
      if (x < kWideRadius || x + kWideRadius >= depth_.cols || depth_.cols < kLanes + 2 * kWideRadius)
        return agreementAt(depth_, {x, y_});
      first_ = std::min(x, depth_.cols - kWideRadius - kLanes);
      near_ = agreeingNeighboursOfBlock(depth_, {first_, y_}, kNearRadius);
      wide_ = agreeingNeighboursOfBlock(depth_, {first_, y_}, kWideRadius);
    }
    const auto i = static_cast<std::size_t>(x - first_);
    return {near_[i], wide_[i]};
  }

 private:
  const DepthImage& depth_;
  int y_, first_ = -kLanes;
  Counts near_{}, wide_{};
};

}  // namespace

int agreeingNeighbours(const DepthImage& depth, const cv::Point& pixel, int radius) {
  const Agreeing agrees(depth(pixel));
  const int spacing = radius / kPerSide;
  const auto firstOf = [&](int centre) { return centre >= radius ? centre - radius : centre % spacing; };
  const int end_x = std::min(pixel.x + radius, depth.cols - 1),
            end_y = std::min(pixel.y + radius, depth.rows - 1);
  int count = -1;  // the pixel itself
  for (int y = firstOf(pixel.y); y <= end_y; y += spacing) {
    const float* const row = depth[y];
    for (int x = firstOf(pixel.x); x <= end_x; x += spacing) count += agrees(row[x]) ? 1 : 0;
  }
  return std::max(count, 0);
}

Agreement agreementAt(const DepthImage& depth, const cv::Point& pixel) {
  return {agreeingNeighbours(depth, pixel, kNearRadius), agreeingNeighbours(depth, pixel, kWideRadius)};
}

template <std::size_t kClasses>
void OtherSurfaces::Sums<kClasses>::add(std::size_t index, double value) {
  frame_pixels[index] += 1.0;
  frame_values[index] += value;
}

template <std::size_t kClasses>
void OtherSurfaces::Sums<kClasses>::endFrame() {
  for (std::size_t i = 0; i < kClasses; ++i) {
    if (frame_pixels[i] == 0.0) continue;  // nothing new: what is known stays
    pixels[i] = Overlap::kMemory * pixels[i] + frame_pixels[i];
    values[i] = Overlap::kMemory * values[i] + frame_values[i];
  }
  frame_pixels = frame_values = {};
}

void OtherSurfaces::observe(const SfmPoints& points, const DepthImage& sfm, const SensorDepth& sensor) {
  const std::size_t stride = points.size() / Overlap::kMaxSamples + 1;
  std::size_t i = 0;
  for (int y = 0; y < sfm.rows; ++y) {
    AgreementsOfRow agreements(sfm, y);
    for (; i < points.end(y); i += stride) {
      const float z = points.sfm[i], d = points.sensor[i];
      if (!(z > 0.0F)) continue;
      unseen_.add(static_cast<std::size_t>(placeOf(z)), d > 0.0F ? 0.0 : 1.0);
      if (!(d <= sensor.noise.max_range)) continue;
      const float squared = (z - d) * (z - d), variance = points.sfm_variance[i] + points.surface_variance[i];
      const bool is_step = squared > kOneSurface * variance;
      const double moment = is_step ? static_cast<double>(std::min(squared / (z * z), 1.0F)) : 0.0;
      moments_.add(classOf(agreements.at(points.columns[i])), moment);
    }
  }
  moments_.endFrame();
  unseen_.endFrame();
  findLikelihoods();
}

void OtherSurfaces::findLikelihoods() {
  double pixels = 0.0, unseen = 0.0;
  for (std::size_t i = 0; i < kDepths; ++i) pixels += unseen_.pixels[i], unseen += unseen_.values[i];
  const double share = unseen / std::max(pixels, 1.0);
  double farther = 0.0, farther_unseen = 0.0;
  for (std::size_t i = kDepths; i-- > 0;) {
    const double here = (unseen_.values[i] + kPriorPixels * share) / (unseen_.pixels[i] + kPriorPixels);
    const double behind = (farther_unseen + kPriorPixels * here) / (farther + kPriorPixels);
    // A hole never speaks for the nearer surface: steps cast shadows, in which the sensor sees nothing.
    likelihoods_[i] = behind > here ? static_cast<float>(behind / here) : 1.0F;
    farther += unseen_.pixels[i];
    farther_unseen += unseen_.values[i];
  }
}

double OtherSurfaces::whereSeen(const Agreement& agreement) const {
  const std::size_t i = classOf(agreement);
  return (moments_.values[i] + kPriorPixels * priorMoment(agreement)) / (moments_.pixels[i] + kPriorPixels);
}

void judgeSfmOnly(const SfmPoints& points, const DepthImage& sfm, const OtherSurfaces& others,
                  const SfmOnlyLimits& limits, FusedDepth& fused) {
  std::array<std::array<float, kMostNeighbours + 1>, kMostNeighbours + 1> where_seen;
  for (int near = 0; near <= kMostNeighbours; ++near) {
    for (int wide = 0; wide <= kMostNeighbours; ++wide)
      where_seen[static_cast<std::size_t>(near)][static_cast<std::size_t>(wide)] =
          static_cast<float>(others.whereSeen({near, wide}));
  }
  const auto most_variance = static_cast<float>(limits.max_relative_sigma * limits.max_relative_sigma);
  const auto most_of_others = static_cast<float>((1.0 - limits.min_probability) * kSquaredStep);
  std::size_t dropped = 0;
  for (int y = 0; y < fused.provenance.rows; ++y) {
    AgreementsOfRow agreements(sfm, y);
    float *const mean = fused.depth.mean[y], *const variance = fused.depth.variance[y];
    std::uint8_t* const provenance = fused.provenance[y];
    const std::uint8_t* const disagreement = fused.disagreement[y];
    points.forEachUnseen(y, [&](std::size_t i) {
      const int x = points.columns[i];
      if (disagreement[x] != 0) return;
      const float z = mean[x];
      if (variance[x] <= most_variance * z * z) {  // it only grows
        const auto [near, wide] = agreements.at(x);
        const float moment =
            others.inHole(where_seen[static_cast<std::size_t>(near)][static_cast<std::size_t>(wide)], z);
        variance[x] += moment * z * z;
        if (moment <= most_of_others && variance[x] <= most_variance * z * z) return;
      }
      mean[x] = variance[x] = kNoDepth;
      provenance[x] = static_cast<std::uint8_t>(Provenance::kNone);
      ++dropped;
    });
  }
  fused.counts.sfm_only -= dropped;
}

void markMeasured(const DepthImage& depth, cv::Mat_<std::uint8_t>& measured) {
  for (int y = 0; y < depth.rows; ++y) markMeasuredRow(depth[y], depth.cols, measured[y]);
}

void markRims(const cv::Mat_<std::uint8_t>& measured, int width, cv::Mat_<std::uint8_t>& marked) {
  if (width == 0) return;
  const cv::Size size = measured.size();
  // Nothing is measured beyond the sides of the image.
  std::vector<std::uint8_t> column(static_cast<std::size_t>(size.width + 2 * width));
  std::vector<std::uint8_t> near(static_cast<std::size_t>(size.width));
  for (int y = 0; y < size.height; ++y) {
    std::fill(column.begin(), column.end(), std::uint8_t{0});
    for (int row = std::max(y - width, 0); row <= std::min(y + width, size.height - 1); ++row)
      addRow(measured[row], size.width, column.data() + width);
    std::fill(near.begin(), near.end(), std::uint8_t{0});
    for (int x = 0; x <= 2 * width; ++x) addRow(column.data() + x, size.width, near.data());
    markRimRow(near.data(), measured[y], size.width, marked[y]);
  }
}

}  // namespace rgbd_sfm_fusion
