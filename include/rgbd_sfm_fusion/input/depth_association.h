// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <utility>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

struct AssociationOptions {
  double max_skew = 0.020;          ///< [s] depth farther from the colour image in time is not used
  double min_depth_period = 0.020;  ///< [s] depth that follows the one before sooner than this is left out,
                                    ///< so that a nearest one is known as such as soon as it is near enough
  std::size_t max_waiting = 30;     ///< images of either stream that wait for the other; then the oldest goes
};

/// @throws std::invalid_argument naming the option that is out of range
void validate(const AssociationOptions& options);

enum class Arrival {
  kAccepted,
  kIgnored,   ///< its stamp is that of the image before, or (depth) too soon after it
  kWentBack,  ///< accepted, but its stamp is before that of the image before: time starts anew
};

/// A colour image and the depth image nearest to it in time, if any is near enough.
template <class Colour, class Depth>
struct ColourDepthPair {
  Stamp stamp = kNoStamp;  ///< of the colour image
  Colour colour{};
  Stamp depth_stamp = kNoStamp;  ///< kNoStamp where no depth belongs to this colour image
  Depth depth{};
  bool starts_anew = false;  ///< its stamp is before that of the colour image before (a bag that loops)
};

namespace association {

/// Whether no depth image can be nearer to `colour` than the nearest of those up to `newest`.
bool isDecided(Stamp colour, Stamp newest, Stamp skew_of_nearest, Stamp min_depth_period);

/// Whether `stamp` is nearer to the time before a jump than to that after it.
bool isFromBefore(Stamp stamp, Stamp before_jump, Stamp after_jump);

Stamp distance(Stamp a, Stamp b);
Stamp nanoseconds(double seconds);

}  // namespace association

/// Gives each colour image the depth image nearest in time (of two as near, the earlier) within max_skew.
///
/// The choice depends on the stamps alone and not on how the two streams interleave, as long as neither lags
/// by more than `max_waiting` images and flush() is not called: a live run and a bag give the same pairs.
/// Every colour image comes out once, in order, as soon as its depth is certain. A depth image may serve two
/// colour images. Payloads are copied: use pointers or cv::Mat.
template <class Colour, class Depth>
class DepthAssociator {
 public:
  using Pair = ColourDepthPair<Colour, Depth>;

  /// @throws std::invalid_argument naming the option that is out of range
  explicit DepthAssociator(const AssociationOptions& options = {})
      : max_skew_((validate(options), association::nanoseconds(options.max_skew))),
        min_depth_period_(association::nanoseconds(options.min_depth_period)),
        max_waiting_(options.max_waiting) {}

  Arrival pushColour(Stamp stamp, Colour colour) {
    const bool went_back = last_colour_ != kNoStamp && stamp < last_colour_;
    if (stamp == last_colour_) return Arrival::kIgnored;
    if (went_back) {
      flush();
      if (!depth_.empty() && association::isFromBefore(depth_.back().stamp, last_colour_, stamp))
        depth_.clear();
    }
    last_colour_ = stamp;
    waiting_.push_back({stamp, std::move(colour), kNoStamp, Depth{}, went_back});
    releaseDecided();
    return went_back ? Arrival::kWentBack : Arrival::kAccepted;
  }

  Arrival pushDepth(Stamp stamp, Depth depth) {
    const bool went_back = last_depth_ != kNoStamp && stamp < last_depth_;
    if (!went_back && last_depth_ != kNoStamp &&
        (stamp == last_depth_ || stamp - last_depth_ < min_depth_period_))
      return Arrival::kIgnored;
    if (went_back) {
      if (association::isFromBefore(last_colour_, last_depth_, stamp)) flush();
      depth_.clear();
    }
    last_depth_ = stamp;
    depth_.push_back({stamp, std::move(depth)});
    releaseDecided();
    return went_back ? Arrival::kWentBack : Arrival::kAccepted;
  }

  /// The next colour image whose depth is certain. To be called until there is none, after each push.
  std::optional<Pair> pop() {
    if (ready_.empty()) return std::nullopt;
    std::optional<Pair> pair = std::move(ready_.front());
    ready_.pop_front();
    return pair;
  }

  /// Makes all waiting colour images ready with the depth at hand: at the end, or when depth fails to come.
  void flush() {
    while (!waiting_.empty()) release();
  }

  /// Colour images that wait for depth.
  std::size_t waiting() const { return waiting_.size(); }

  /// Forgets all images, and the stamps seen.
  void reset() {
    waiting_.clear();
    ready_.clear();
    depth_.clear();
    last_colour_ = last_depth_ = kNoStamp;
  }

 private:
  struct StampedDepth {
    Stamp stamp;
    Depth payload;
  };

  const StampedDepth* nearestDepth(Stamp colour) const {
    const StampedDepth* nearest = nullptr;
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
      const StampedDepth* nearest = nearestDepth(colour);
      const bool decided =
          nearest != nullptr &&
          association::isDecided(colour, depth_.back().stamp, association::distance(nearest->stamp, colour),
                                 min_depth_period_);
      if (!decided && waiting_.size() <= max_waiting_) break;
      release();
    }
    forgetUnneededDepth();
  }

  void release() {
    Pair pair = std::move(waiting_.front());
    waiting_.pop_front();
    const StampedDepth* nearest = nearestDepth(pair.stamp);
    if (nearest != nullptr && association::distance(nearest->stamp, pair.stamp) <= max_skew_) {
      pair.depth_stamp = nearest->stamp;
      pair.depth = nearest->payload;
    }
    ready_.push_back(std::move(pair));
  }

  /// Of the depth images up to the next colour image, only the last can still be the nearest.
  void forgetUnneededDepth() {
    const Stamp next_colour = waiting_.empty() ? last_colour_ : waiting_.front().stamp;
    while (depth_.size() > 1 && (depth_[1].stamp <= next_colour || depth_.size() > max_waiting_))
      depth_.pop_front();
  }

  Stamp max_skew_;
  Stamp min_depth_period_;
  std::size_t max_waiting_;
  std::deque<Pair> waiting_;
  std::deque<Pair> ready_;
  std::deque<StampedDepth> depth_;
  Stamp last_colour_ = kNoStamp;
  Stamp last_depth_ = kNoStamp;
};

}  // namespace rgbd_sfm_fusion
