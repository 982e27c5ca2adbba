// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/propagation.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "rgbd_sfm_fusion/sampling.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr float kMaxNoise = 6.0F;  // [σ] of a pixel's brightness, by which it may change

/// An estimate beside a pixel, as a number that is the smaller the nearer its projection is; of equally near
/// ones, the first one's.
struct Beside {
  explicit Beside(std::uint64_t that) : key(that) {}
  /// @param distance  [px] along the axis where it is larger; not negative
  Beside(float distance, int index) {
    std::uint32_t bits = 0;  // in the order of the numbers
    std::memcpy(&bits, &distance, sizeof(bits));
    key = std::uint64_t{bits} << 32U | static_cast<std::uint32_t>(index);
  }

  /// -1: it is not within a pixel.
  int index() const { return key < Beside(1.0F, 0).key ? static_cast<int>(key & 0xFFFFFFFFU) : -1; }

  std::uint64_t key = 0;
};

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
  to.observations[0][pixel] = from.observations[0][origin];
  to.rejections[0][pixel] = from.rejections[0][origin];
  to.scatter[0][pixel] = from.scatter[0][origin];
}

}  // namespace

Propagation::Propagation(const cv::Size& size)
    : row_(size.width), same_(static_cast<std::size_t>(size.area())), carried_(size), beside_(same_.size()) {
  warped_.resize(same_.size());
  targets_.resize(same_.size());
}

void Propagation::run(const KeyframeChange& change, const SemiDenseMap& from,
                      const StereoCandidates& candidates, const MappingOptions& options, SemiDenseMap& to) {
  warpAll(change, from);
  compareBrightness(change, kMaxNoise * options.image_noise);
  placeAll(from);
  fillGaps(candidates);
  carryAll(from, to);
}

void Propagation::warpAll(const KeyframeChange& change, const SemiDenseMap& from) {
  const cv::Mat_<float>& mean = from.estimate.mean;
  origins_.clear();
  std::size_t count = 0;
  for (int v = 0; v < mean.rows; ++v) {
    row_.gather(mean[v]);
    change.warp.row(v, row_.columns.data(), row_.values.data(), row_.count, count, warped_);
    for (std::size_t i = 0; i < row_.count; ++i) origins_.push_back(v * mean.cols + row_.columns[i]);
    count += row_.count;
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
      const float expected = gain * static_cast<float>(change.from_image[0][origins_[first + l]]) + offset;
      same_[first + l] = has_neighbours[l] && std::abs(there[l] - expected) <= max_difference ? 1 : 0;
    }
  }
}

/// Finds which estimate each pixel gets, and which one is nearest to it.
void Propagation::placeAll(const SemiDenseMap& from) {
  carried_.setTo(-1);
  std::fill(beside_.begin(), beside_.end(), Beside(1.0F, 0).key);
  const auto width = static_cast<std::size_t>(carried_.cols);
  for (std::size_t i = 0; i < origins_.size(); ++i) {
    if (same_[i] == 0) continue;
    const auto index = static_cast<int>(i);
    int& there = carried_[0][warped_.pixel[i]];
    if (there < 0 || prevails(i, static_cast<std::size_t>(there), from)) there = index;
    // The projection is inside the image, and so are the four pixels round it.
    const float u = warped_.u[i], v = warped_.v[i];
    const auto left = static_cast<std::size_t>(u), top = static_cast<std::size_t>(v);
    const float to_left = u - static_cast<float>(left), to_top = v - static_cast<float>(top);
    const float to_right = 1.0F - to_left, to_bottom = 1.0F - to_top;
    std::uint64_t* const above = &beside_[top * width + left];
    std::uint64_t* const below = above + width;
    above[0] = std::min(above[0], Beside(std::max(to_left, to_top), index).key);
    above[1] = std::min(above[1], Beside(std::max(to_right, to_top), index).key);
    below[0] = std::min(below[0], Beside(std::max(to_left, to_bottom), index).key);
    below[1] = std::min(below[1], Beside(std::max(to_right, to_bottom), index).key);
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

/// Gives each candidate without an estimate the nearest one that had a neighbour which came to a neighbour of
/// the candidate, from the same side.
void Propagation::fillGaps(const StereoCandidates& candidates) {
  gaps_.clear();
  for (const std::vector<StereoCandidates::Block>& band : candidates.bands()) {
    for (const StereoCandidates::Block& block : band) {
      for (const int pixel : block.pixel) {
        if (carried_[0][pixel] >= 0) continue;
        int estimate = Beside(beside_[static_cast<std::size_t>(pixel)]).index();
        if (estimate < 0) continue;  // as for most
        if (!belongsBeside(estimate, pixel)) estimate = nearestNeighbour(pixel);
        if (estimate >= 0) gaps_.push_back({pixel, estimate});
      }
    }
  }
  for (const Gap& gap : gaps_) carried_[0][gap.pixel] = gap.estimate;
}

std::array<int, 8> Propagation::around() const {
  const int width = carried_.cols;
  return {-width - 1, -width, -width + 1, -1, 1, width - 1, width, width + 1};
}

bool Propagation::belongsBeside(int estimate, int pixel) const {
  const int origin = origins_[static_cast<std::size_t>(estimate)];
  bool found = false;
  for (const int step : around()) {
    const int beside = carried_[0][pixel + step];
    found |= (beside >= 0) & (origins_[static_cast<std::size_t>(std::max(beside, 0))] == origin + step);
  }
  return found;
}

/// @return -1: there is none within a pixel
int Propagation::nearestNeighbour(int pixel) const {
  const auto u = static_cast<float>(pixel % carried_.cols), v = static_cast<float>(pixel / carried_.cols);
  float nearest = 1.0F;  // [px]
  int best = -1;
  for (const int step : around()) {
    const int beside = carried_[0][pixel + step];
    if (beside < 0) continue;
    const int origin = origins_[static_cast<std::size_t>(beside)] - step;
    const int index = indexOf(origin);
    if (index < 0) continue;
    const auto i = static_cast<std::size_t>(index);
    const float distance = std::max(std::abs(warped_.u[i] - u), std::abs(warped_.v[i] - v));
    if (same_[i] == 0 || distance >= nearest) continue;
    nearest = distance;
    best = index;
  }
  return best;
}

int Propagation::indexOf(int origin) const {
  const auto found = std::lower_bound(origins_.begin(), origins_.end(), origin);
  return found != origins_.end() && *found == origin ? static_cast<int>(found - origins_.begin()) : -1;
}

void Propagation::carryAll(const SemiDenseMap& from, SemiDenseMap& to) {
  to.clear();
  const auto total = static_cast<int>(carried_.total());
  std::size_t count = 0;
  for (int pixel = 0; pixel < total; ++pixel) {
    targets_[count] = pixel;
    count += carried_[0][pixel] >= 0 ? 1U : 0U;
  }
  for (std::size_t n = 0; n < count; ++n) {
    const int pixel = targets_[n];
    const auto i = static_cast<std::size_t>(carried_[0][pixel]);
    put(carriedBy(warped_, i, from.estimate.variance[0][origins_[i]]), warped_.derivative[i], from,
        origins_[i], pixel, to);
  }
}

}  // namespace rgbd_sfm_fusion
