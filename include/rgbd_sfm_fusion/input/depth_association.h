// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

#include "rgbd_sfm_fusion/input/time_line.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

struct AssociationOptions {
  double max_skew = 0.020;          ///< [s] depth farther from the colour image in time is not used
  double min_depth_period = 0.020;  ///< [s] depth that follows the depth before sooner than this is left out,
                                    ///< so that depth that is near enough is known to be the nearest
  std::size_t max_waiting = 30;     ///< so many images of a stream wait for the other; then the oldest goes
};

/// @throws std::invalid_argument naming the option that is out of range
void validate(const AssociationOptions& options);

/// Runs are counted from 1 on, as people do.
constexpr std::uint32_t kFirstRun = 1;

/// A colour image and the depth image nearest to it in time, if any is near enough.
template <class Colour, class Depth>
struct ColourDepthPair {
  Stamp stamp = kNoStamp;  ///< of the colour image
  Colour colour{};
  Stamp depth_stamp = kNoStamp;  ///< kNoStamp where no depth belongs to this colour image
  Depth depth{};
  Stamp nearest_depth = kNoStamp;  ///< of the nearest depth image, used or not; kNoStamp: none is known
  std::uint32_t run = kFirstRun;   ///< goes up by one when the time of colour images starts anew
};

namespace association {

/// Learns the time from one depth image to the next, from stamps.
class DepthPeriod {
 public:
  /// @param least  no shorter period is possible
  explicit DepthPeriod(Stamp least) : least_(least) {}

  /// Takes the next depth image. @return the shortest time to the one after it, as far as the last ones tell
  Stamp next(Stamp stamp);
  void reset() { stamps_.clear(); }

 private:
  static constexpr std::size_t kLearnedFrom = 10;  // times between images, a third of a second
  Stamp least_;
  std::deque<Stamp> stamps_;  // the last ones
};

/// True if `stamp` is nearer to the time before a jump than to the time after it.
bool isFromBefore(Stamp stamp, Stamp before_jump, Stamp after_jump);

Stamp distance(Stamp a, Stamp b);
Stamp nanoseconds(double seconds);

}  // namespace association

/// Pairs each colour image with the depth image that is nearest in time and within max_skew. Of two depth
/// images that are equally near, the earlier one is taken. A depth image that came before the colour image,
/// by less than half of the time that depth images are apart, is taken to be the nearest: there is no wait
/// for the next one. That time is min_depth_period, or what the last images tell, if that is longer.
///
/// The choice depends on the stamps alone, not on how the two streams interleave, so a live run and a bag
/// give the same pairs. That holds as long as neither stream lags by more than `max_waiting` images, and
/// flush() is not called. Every colour image on its time line comes out once, in order, as soon as its depth
/// is certain. One depth image may serve two colour images. Payloads are copied: use pointers or cv::Mat.
///
/// Where the time line of colour goes back, a new run begins. Every pair carries the number of its run. So
/// the change of run is noticed even if the first pair of a run gets lost on the way.
template <class Colour, class Depth>
class DepthAssociator {
 public:
  using Pair = ColourDepthPair<Colour, Depth>;

  /// @throws std::invalid_argument naming the option that is out of range
  explicit DepthAssociator(const AssociationOptions& options = {})
      : max_skew_((validate(options), association::nanoseconds(options.max_skew))),
        min_depth_period_(association::nanoseconds(options.min_depth_period)),
        period_(min_depth_period_),
        max_waiting_(options.max_waiting) {}

  void pushColour(Stamp stamp, Colour colour) {
    takeColour(colour_line_.push(stamp, std::move(colour)));
    releaseDecided();
  }

  void pushDepth(Stamp stamp, Depth depth) {
    takeDepth(depth_line_.push(stamp, std::move(depth)));
    releaseDecided();
  }

  /// The next colour image whose depth is certain. After each push, call pop() until it returns nothing.
  std::optional<Pair> pop() {
    if (ready_.empty()) return std::nullopt;
    std::optional<Pair> pair = std::move(ready_.front());
    ready_.pop_front();
    return pair;
  }

  /// Makes all waiting colour images ready with the depth that has come. For use when depth fails to come.
  void flush() {
    while (!waiting_.empty()) release();
  }

  /// For the end of both streams: images stop waiting for depth that could be nearer.
  void finish() {
    takeDepth(depth_line_.finish());
    takeColour(colour_line_.finish());
    releaseDecided();
    flush();
  }

  /// Number of colour images that wait for depth.
  std::size_t waiting() const { return waiting_.size(); }

  const StreamCounts& colourCounts() const { return colour_line_.counts(); }
  StreamCounts depthCounts() const {
    StreamCounts counts = depth_line_.counts();
    counts.accepted -= too_soon_;
    counts.too_soon = too_soon_;
    return counts;
  }

  /// Forgets all images, and the stamps seen: the next image begins a new run.
  void reset() {
    waiting_.clear();
    ready_.clear();
    depth_.clear();
    colour_line_.reset();
    depth_line_.reset();
    last_used_depth_ = kNoStamp;
    period_.reset();
    ++run_;
  }

 private:
  struct StampedDepth {
    Stamp stamp;
    Stamp period;  ///< least time to the next one
    Depth payload;
  };

  void takeColour(typename TimeLine<Colour>::Accepted accepted) {
    if (accepted.line_before) {
      flush();
      const Stamp after = accepted.images.back().stamp;
      if (!depth_.empty() && association::isFromBefore(depth_.back().stamp, *accepted.line_before, after))
        depth_.clear();
      ++run_;
    }
    for (auto& [stamp, colour] : accepted.images)
      waiting_.push_back({stamp, std::move(colour), kNoStamp, Depth{}, kNoStamp, run_});
  }

  void takeDepth(typename TimeLine<Depth>::Accepted accepted) {
    if (accepted.line_before) {
      const Stamp after = accepted.images.back().stamp;
      if (association::isFromBefore(colour_line_.last(), *accepted.line_before, after)) flush();
      depth_.clear();
      last_used_depth_ = kNoStamp;
      period_.reset();
    }
    for (auto& [stamp, depth] : accepted.images) {
      if (last_used_depth_ != kNoStamp && stamp - last_used_depth_ < min_depth_period_) {
        ++too_soon_;
        continue;
      }
      last_used_depth_ = stamp;
      depth_.push_back({stamp, period_.next(stamp), std::move(depth)});
    }
  }

  /// The depth image that is taken to be the nearest without a look at later ones: the first such one.
  const StampedDepth* decidedDepth(Stamp colour) const {
    const auto isNear = [&](const StampedDepth& depth) {
      const Stamp skew = colour - depth.stamp;
      return skew >= 0 && 2 * skew < (skew <= max_skew_ ? depth.period : min_depth_period_);
    };
    const auto found = std::find_if(depth_.begin(), depth_.end(), isNear);
    return found == depth_.end() ? nullptr : &*found;
  }

  const StampedDepth* nearestDepth(Stamp colour) const {
    const StampedDepth* nearest = decidedDepth(colour);
    if (nearest != nullptr) return nearest;
    for (const StampedDepth& candidate : depth_) {
      if (nearest == nullptr ||
          association::distance(candidate.stamp, colour) < association::distance(nearest->stamp, colour))
        nearest = &candidate;
    }
    return nearest;
  }

  void releaseDecided() {
    while (!waiting_.empty()) {
      const Stamp colour = waiting_.front().stamp;
      const bool has_later = !depth_.empty() && depth_.back().stamp >= colour;
      if (!has_later && decidedDepth(colour) == nullptr && waiting_.size() <= max_waiting_) break;
      release();
    }
    forgetUnneededDepth();
  }

  void release() {
    Pair pair = std::move(waiting_.front());
    waiting_.pop_front();
    const StampedDepth* nearest = nearestDepth(pair.stamp);
    if (nearest != nullptr) pair.nearest_depth = nearest->stamp;
    if (nearest != nullptr && association::distance(nearest->stamp, pair.stamp) <= max_skew_) {
      pair.depth_stamp = nearest->stamp;
      pair.depth = nearest->payload;
    }
    ready_.push_back(std::move(pair));
  }

  /// Of the depth images up to the next colour image, only the last can still be the nearest, and those that
  /// need no look at later ones.
  void forgetUnneededDepth() {
    Stamp next_colour = waiting_.empty() ? colour_line_.last() : waiting_.front().stamp;
    next_colour = std::min(next_colour, colour_line_.earliestHeld().value_or(next_colour));
    const auto isPast = [&] {
      return depth_[1].stamp <= next_colour && 2 * (next_colour - depth_[0].stamp) >= depth_[0].period;
    };
    while (depth_.size() > 1 && (isPast() || depth_.size() > max_waiting_)) depth_.pop_front();
  }

  Stamp max_skew_;
  Stamp min_depth_period_;
  association::DepthPeriod period_;
  std::size_t max_waiting_;
  TimeLine<Colour> colour_line_;
  TimeLine<Depth> depth_line_;
  std::deque<Pair> waiting_;
  std::deque<Pair> ready_;
  std::deque<StampedDepth> depth_;
  Stamp last_used_depth_ = kNoStamp;
  std::size_t too_soon_ = 0;
  std::uint32_t run_ = kFirstRun;
};

}  // namespace rgbd_sfm_fusion
