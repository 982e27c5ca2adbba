// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/propagation.h"

#include <algorithm>
#include <cmath>

#include "rgbd_sfm_fusion/image/brightness.h"
#include "rgbd_sfm_fusion/sampling.h"

namespace rgbd_sfm_fusion {
namespace {

struct Carried {
  float inverse_depth, variance;
};

Carried carriedBy(const WarpedPoints& warped, std::size_t i, float variance) {
  const float noise = kCarriedRelativeSigma * warped.inverse_depth[i];
  return {warped.inverse_depth[i], warped.derivative[i] * warped.derivative[i] * variance + noise * noise};
}

void put(const Carried& carried, float derivative, const SemiDenseMap& from, int origin, int pixel,
         SemiDenseMap& to) {
  to.estimate.mean[0][pixel] = carried.inverse_depth;
  to.estimate.variance[0][pixel] = carried.variance;
  to.by_readout[0][pixel] = derivative * from.by_readout[0][origin];
  to.by_pose[0][pixel] = derivative * from.by_pose[0][origin];
  to.observations[0][pixel] = from.observations[0][origin];
  to.rejections[0][pixel] = from.rejections[0][origin];
  to.scatter[0][pixel] = from.scatter[0][origin];
}

}  // namespace

Propagation::Propagation(const cv::Size& size)
    : row_(size.width), same_(static_cast<std::size_t>(size.area())), at_origin_(size, 0), carried_(size) {
  warped_.resize(at_origin_.total());
}

void Propagation::run(const KeyframeChange& change, const SemiDenseMap& from,
                      const StereoCandidates& candidates, const MappingOptions& options, SemiDenseMap& to) {
  warpAll(change, from);
  // In either image, a pixel's brightness may be 3 σ off.
  compareBrightness(change, 2.0F * std::sqrt(kOneSurface) * options.image_noise);
  carryAll(from, to);
  fillGaps(candidates, from, to);
}

void Propagation::warpAll(const KeyframeChange& change, const SemiDenseMap& from) {
  const cv::Mat_<float>& mean = from.estimate.mean;
  origins_.clear();
  std::size_t count = 0;
  for (int v = 0; v < mean.rows; ++v) {
    row_.gather(mean[v]);
    change.warp.row(v, row_.columns.data(), row_.values.data(), row_.count, count, warped_);
    for (std::size_t i = 0; i < row_.count; ++i, ++count) {
      const int origin = v * mean.cols + row_.columns[i];
      origins_.push_back(origin);
      at_origin_[0][origin] = static_cast<int>(count);
    }
  }
}

/// Compares brightness interpolated between pixels. If projections were rounded to pixels, brightness would
/// differ at every sharp edge.
void Propagation::compareBrightness(const KeyframeChange& change, float max_difference) {
  const cv::Mat_<float>& image = change.to_image;
  const auto gain = static_cast<float>(change.brightness.gain),
             offset = static_cast<float>(change.brightness.offset);
  const auto min_u = static_cast<float>(change.seen.x), min_v = static_cast<float>(change.seen.y);
  const auto max_u = static_cast<float>(change.seen.br().x - 1),
             max_v = static_cast<float>(change.seen.br().y - 1);
  const std::size_t count = origins_.size();
  for (std::size_t first = 0; first < count; first += kLanes) {
    const std::size_t lanes = std::min<std::size_t>(kLanes, count - first);
    float u[kLanes] = {}, v[kLanes] = {}, there[kLanes];
    bool has_neighbours[kLanes] = {};
    for (std::size_t l = 0; l < lanes; ++l) {
      const float at_u = warped_.u[first + l], at_v = warped_.v[first + l];
      has_neighbours[l] = (warped_.pixel[first + l] >= 0) & (at_u >= min_u) & (at_v >= min_v) &
                          (at_u < max_u) & (at_v < max_v);
      u[l] = has_neighbours[l] ? at_u : 0.0F;
      v[l] = has_neighbours[l] ? at_v : 0.0F;
    }
    sampleBlock(image[0], static_cast<int>(image.step1()), u, v, there);
    for (std::size_t l = 0; l < lanes; ++l) {
      const float expected =
          shown(gain * static_cast<float>(change.from_image[0][origins_[first + l]]) + offset);
      same_[first + l] = has_neighbours[l] && std::abs(there[l] - expected) <= max_difference ? 1 : 0;
    }
  }
}

void Propagation::carryAll(const SemiDenseMap& from, SemiDenseMap& to) {
  to.clear();
  carried_.setTo(-1);
  for (std::size_t i = 0; i < origins_.size(); ++i) {
    if (same_[i] == 0) continue;
    const int pixel = warped_.pixel[i];
    const Carried carried = carriedBy(warped_, i, from.estimate.variance[0][origins_[i]]);
    const int there = carried_[0][pixel];
    if (there >= 0 && !prevails(i, static_cast<std::size_t>(there), from)) continue;
    put(carried, warped_.derivative[i], from, origins_[i], pixel, to);
    carried_[0][pixel] = static_cast<int>(i);
  }
}

/// Whether the estimate `i` replaces the estimate `there`, which came to the same pixel: the nearer surface
/// wins; on one surface, the better estimate. Variances are compared as they were before the move. The move
/// changes them by inverse depth, so that among equals the one with a certain error would win, and such
/// errors would add up from keyframe to keyframe.
bool Propagation::prevails(std::size_t i, std::size_t there, const SemiDenseMap& from) const {
  const float variance = from.estimate.variance[0][origins_[i]],
              variance_there = from.estimate.variance[0][origins_[there]];
  const Carried carried = carriedBy(warped_, i, variance), other = carriedBy(warped_, there, variance_there);
  const float deviation = carried.inverse_depth - other.inverse_depth;
  const bool same_surface = deviation * deviation < kOneSurface * (carried.variance + other.variance);
  return same_surface ? variance < variance_there : deviation >= 0.0F;
}

/// Gives each candidate without an estimate the estimate whose projection is nearest, within a pixel.
void Propagation::fillGaps(const StereoCandidates& candidates, const SemiDenseMap& from,
                           SemiDenseMap& to) const {
  for (const std::vector<StereoCandidates::Block>& band : candidates.bands()) {
    for (const StereoCandidates::Block& block : band) {
      for (const int pixel : block.pixel) {
        if (to.observations[0][pixel] != 0) continue;
        const int nearest = nearestTo(pixel, from);
        if (nearest < 0) continue;
        const auto i = static_cast<std::size_t>(nearest);
        put(carriedBy(warped_, i, from.estimate.variance[0][origins_[i]]), warped_.derivative[i], from,
            origins_[i], pixel, to);
      }
    }
  }
}

/// @return index of the estimate; -1: there is none
int Propagation::nearestTo(int pixel, const SemiDenseMap& from) const {
  const int width = carried_.cols;
  const auto u = static_cast<float>(pixel % width), v = static_cast<float>(pixel / width);
  const int* there = carried_[0] + pixel;
  // Negative where all eight are. Most pixels without an estimate have no neighbour with one.
  const int beside_all = there[-width - 1] & there[-width] & there[-width + 1] & there[-1] & there[1] &
                         there[width - 1] & there[width] & there[width + 1];
  if (beside_all < 0) return -1;
  float nearest = 1.0F;  // [px]
  int best = -1;
  // The estimate that came to the pixel's neighbour had a neighbour, too, which may belong to the pixel.
  // There is no branch, which could not be predicted: where there is no such estimate, any other one is
  // looked at in its stead, and not taken.
  const auto total = static_cast<int>(at_origin_.total());
  for (const int step : {-width - 1, -width, -width + 1, -1, 1, width - 1, width, width + 1}) {
    const int beside = there[step];
    const int origin = origins_[static_cast<std::size_t>(std::max(beside, 0))] - step;
    const bool is_inside = (beside >= 0) & (origin >= 0) & (origin < total);
    const int place = is_inside ? origin : pixel;
    const int index = at_origin_[0][place];
    const auto i = static_cast<std::size_t>(index);
    const float distance = std::max(std::abs(warped_.u[i] - u), std::abs(warped_.v[i] - v));
    const bool is_nearer =
        is_inside & (from.observations[0][place] != 0) & (same_[i] != 0) & (distance < nearest);
    nearest = is_nearer ? distance : nearest;
    best = is_nearer ? index : best;
  }
  return best;
}

}  // namespace rgbd_sfm_fusion
