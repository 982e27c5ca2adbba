// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/semi_dense_map.h"

#include <algorithm>
#include <cmath>

namespace rgbd_sfm_fusion {
namespace {

constexpr float kMaxSquaredDeviation = 9.0F;  // [σ²] of an observation from the estimate
constexpr int kMaxRejections = 4;
constexpr float kRejectionGrowth = 1.2F;  // of the variance
// [σ²] Scatter of one observation: the most that counts, and the value without a match.
constexpr float kMaxScatter = 16.0F, kUnmatchedScatter = 9.0F;
// [observations] The weight of the first value, 1, and the number that the mean remembers.
constexpr int kScatterPrior = 2, kScatterMemory = 16;

/// Carries estimates from one keyframe's map to another's.
class Carrier {
 public:
  Carrier(const KeyframeChange& change, const SemiDenseMap& from, const MappingOptions& options,
          SemiDenseMap& to)
      : change_(change),
        from_(from),
        to_(to),
        gain_(static_cast<float>(change.brightness.gain)),
        offset_(static_cast<float>(change.brightness.offset)),
        max_difference_(6.0F * options.image_noise),
        origins_(from.observations.size(), -1) {}

  /// Carries each estimate to the pixel nearest to its projection.
  void carryAll() {
    for (int v = 0; v < from_.observations.rows; ++v) {
      for (int u = 0; u < from_.observations.cols; ++u) {
        if (from_.observations(v, u) == 0) continue;
        const auto point = change_.warp(u, v, from_.estimate.mean(v, u));
        if (!point || !looksTheSame(u, v, *point)) continue;
        const int pixel = point->row * to_.observations.cols + point->column;
        const Carried carried = at(u, v, *point);
        if (!prevails(carried, pixel)) continue;
        put(carried, v * from_.observations.cols + u, pixel);
      }
    }
  }

  /// Gives each candidate without an estimate the estimate whose projection is nearest, within a pixel.
  void fillGaps(const StereoCandidates& candidates) {
    const cv::Mat_<int> origins = origins_.clone();  // so that no gap is filled from another gap
    for (int i = 0; i < candidates.count; ++i) {
      const int pixel = candidates.pixel(i);
      if (to_.observations[0][pixel] == 0) fillGap(origins, pixel);
    }
  }

 private:
  struct Carried {
    float inverse_depth, variance, derivative;
  };

  /// Whether a pixel of the old keyframe and its projection in the new one have the same brightness. The
  /// latter is interpolated between pixels. If it were rounded to a pixel, brightness would differ at every
  /// sharp edge.
  bool looksTheSame(int u, int v, const InverseDepthWarp::Point& point) const {
    const cv::Mat_<float>& image = change_.to_image;
    const int left = static_cast<int>(point.u), top = static_cast<int>(point.v);
    const cv::Rect& seen = change_.seen;
    if (point.u < static_cast<float>(seen.x) || point.v < static_cast<float>(seen.y) ||
        left + 1 >= seen.br().x || top + 1 >= seen.br().y)
      return false;
    const float right = point.u - static_cast<float>(left), bottom = point.v - static_cast<float>(top);
    const float above = image(top, left) + right * (image(top, left + 1) - image(top, left));
    const float below = image(top + 1, left) + right * (image(top + 1, left + 1) - image(top + 1, left));
    const float there = above + bottom * (below - above);
    return std::abs(there - gain_ * change_.from_image(v, u) - offset_) <= max_difference_;
  }

  Carried at(int u, int v, const InverseDepthWarp::Point& point) const {
    constexpr float kRelativeNoise = 0.01F;  // of inverse depth: the pixel's centre is beside it
    const float noise = kRelativeNoise * point.inverse_depth;
    const float variance = point.derivative * point.derivative * from_.estimate.variance(v, u);
    return {point.inverse_depth, variance + noise * noise, point.derivative};
  }

  /// Whether an estimate replaces the one that the pixel has: the nearer surface wins; on one surface, the
  /// better estimate.
  bool prevails(const Carried& carried, int pixel) const {
    const float mean = to_.estimate.mean[0][pixel], variance = to_.estimate.variance[0][pixel];
    if (mean <= 0.0F) return true;
    const float deviation = carried.inverse_depth - mean;
    const bool same_surface = deviation * deviation < kMaxSquaredDeviation * (carried.variance + variance);
    return same_surface ? carried.variance < variance : deviation >= 0.0F;
  }

  void put(const Carried& carried, int origin, int pixel) {
    constexpr int kMaxObservations = 8;
    to_.estimate.mean[0][pixel] = carried.inverse_depth;
    to_.estimate.variance[0][pixel] = carried.variance;
    to_.by_readout[0][pixel] = carried.derivative * from_.by_readout[0][origin];
    to_.observations[0][pixel] =
        static_cast<std::uint8_t>(std::min<int>(from_.observations[0][origin], kMaxObservations));
    to_.rejections[0][pixel] = from_.rejections[0][origin];
    to_.scatter[0][pixel] = from_.scatter[0][origin];
    origins_[0][pixel] = origin;
  }

  void fillGap(const cv::Mat_<int>& origins, int pixel) {
    const int width = origins.cols;
    const auto u = static_cast<float>(pixel % width), v = static_cast<float>(pixel / width);
    float nearest = 1.0F;  // [px]
    int best = -1;
    InverseDepthWarp::Point best_point;
    // The estimate that came to the pixel's neighbour had a neighbour, too, which may belong to the pixel.
    for (const int step : {-width - 1, -width, -width + 1, -1, 1, width - 1, width, width + 1}) {
      const int origin = origins[0][pixel + step] - step;
      if (origins[0][pixel + step] < 0 || origin < 0 || origin >= static_cast<int>(origins.total())) continue;
      if (from_.observations[0][origin] == 0) continue;
      const int column = origin % width, row = origin / width;
      const auto point = change_.warp(column, row, from_.estimate.mean[0][origin]);
      if (!point) continue;
      const float distance = std::max(std::abs(point->u - u), std::abs(point->v - v));
      if (distance >= nearest || !looksTheSame(column, row, *point)) continue;
      nearest = distance;
      best = origin;
      best_point = *point;
    }
    if (best >= 0) put(at(best % width, best / width, best_point), best, pixel);
  }

  const KeyframeChange& change_;
  const SemiDenseMap& from_;
  SemiDenseMap& to_;
  float gain_, offset_, max_difference_;
  cv::Mat_<int> origins_;  // per new pixel, the old keyframe's pixel that its estimate comes from; -1: none
};

}  // namespace

void SemiDenseMap::create(const cv::Size& size) {
  estimate.create(size);
  by_readout.create(size);
  observations.create(size);
  rejections.create(size);
  scatter.create(size);
}

void SemiDenseMap::clear() {
  estimate.clear();
  by_readout.setTo(0.0);
  observations.setTo(0);
  rejections.setTo(0);
  scatter.setTo(1.0);
}

void SemiDenseMap::clearPixel(int pixel) {
  estimate.mean[0][pixel] = 0.0F;
  estimate.variance[0][pixel] = std::numeric_limits<float>::infinity();
  by_readout[0][pixel] = 0.0F;
  observations[0][pixel] = 0;
  rejections[0][pixel] = 0;
  scatter[0][pixel] = 1.0F;
}

void update(const std::vector<StereoObservation>& observations, SemiDenseMap& map) {
  float *means = map.estimate.mean[0], *variances = map.estimate.variance[0];
  std::uint8_t *counts = map.observations[0], *rejections = map.rejections[0];
  float *scatters = map.scatter[0], *by_readout = map.by_readout[0];
  for (const StereoObservation& observed : observations) {
    const int i = observed.pixel;
    if (counts[i] == 0) {
      if (!observed.matched) continue;
      means[i] = observed.inverse_depth;
      variances[i] = observed.variance;
      by_readout[i] = observed.by_readout;
      counts[i] = 1;
      rejections[i] = 0;
      scatters[i] = 1.0F;
      continue;
    }
    const float deviation = observed.inverse_depth - means[i];
    const float squared = deviation * deviation, expected = variances[i] + observed.variance;
    const float scatter = observed.matched ? std::min(squared / expected, kMaxScatter) : kUnmatchedScatter;
    scatters[i] += (scatter - scatters[i]) /
                   static_cast<float>(std::min<int>(counts[i] + kScatterPrior, kScatterMemory));
    if (!observed.matched || squared > kMaxSquaredDeviation * expected) {
      variances[i] *= kRejectionGrowth;
      if (++rejections[i] > kMaxRejections) map.clearPixel(i);
      continue;
    }
    const float gain = variances[i] / (variances[i] + observed.variance);
    means[i] += gain * deviation;
    variances[i] *= 1.0F - gain;
    by_readout[i] += gain * (observed.by_readout - by_readout[i]);
    if (means[i] <= 0.0F) {
      map.clearPixel(i);
      continue;
    }
    counts[i] = static_cast<std::uint8_t>(std::min(counts[i] + 1, 255));
    if (rejections[i] > 0) --rejections[i];
  }
}

void propagate(const KeyframeChange& change, const SemiDenseMap& from, const StereoCandidates& candidates,
               const MappingOptions& options, SemiDenseMap& to) {
  to.clear();
  Carrier carrier(change, from, options, to);
  carrier.carryAll();
  carrier.fillGaps(candidates);
}

}  // namespace rgbd_sfm_fusion
