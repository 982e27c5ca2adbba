// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// What became of the images of a stream.
struct StreamCounts {
  std::size_t accepted = 0;
  std::size_t late = 0;       ///< left out: stamped before one that came before, or far ahead, just this once
  std::size_t repeated = 0;   ///< left out: the same stamp again
  std::size_t too_soon = 0;   ///< left out: sooner after the one before than is of use
  std::size_t unstamped = 0;  ///< left out: a stamp of 0, which is ROS's "no time"

  std::size_t leftOut() const { return late + repeated + too_soon + unstamped; }
};

namespace time_line {

constexpr Stamp kLongestStep = 10'000'000'000;  ///< [ns] a longer one has to be confirmed
constexpr std::size_t kConfirmations = 5;       ///< images that continue each other make a time line
constexpr std::size_t kMostCandidates = 4;

/// Whether `stamp` is what may be expected after `last`.
bool continues(Stamp last, Stamp stamp);

}  // namespace time_line

/// Puts the images of a stream on one line of rising stamps, and leaves out those that are not on it.
///
/// An image whose stamp is not after that of the one before, or far ahead of it, is either a slip (a message
/// that was overtaken, a wrong stamp) or the first of many: a bag that loops, a clock that was set. Which one
/// is known soon: it is held, together with those that continue it. As soon as an image continues the old
/// line, what is held was a slip, and is left out. When kConfirmations of them are held, they are the new
/// line, and all of them are given out. So a single stamp of 1970 or of next year changes nothing, a bag that
/// loops loses nothing, and no stamp makes all later ones late for ever. Of streams that are interleaved,
/// with clocks of their own, one is taken.
template <class Image>
class TimeLine {
 public:
  struct Item {
    Stamp stamp;
    Image image;
  };
  struct Accepted {
    std::vector<Item> images;          ///< stamps rise
    std::optional<Stamp> line_before;  ///< where time has gone back: the last stamp before that
  };

  /// @return the images that are now known to be on the line
  Accepted push(Stamp stamp, Image image) {
    if (stamp < 0) {
      ++counts_.unstamped;
      return {};
    }
    if (last_ == kNoStamp || time_line::continues(last_, stamp)) {
      giveUp();
      return accept({{stamp, std::move(image)}});
    }
    if (stamp == last_) {
      ++counts_.repeated;
      return {};
    }
    return hold({stamp, std::move(image)});
  }

  /// At the end of the stream. @return what is held and ahead: nothing contradicts it any more
  Accepted finish() {
    Accepted accepted;
    if (!candidates_.empty() && candidates_.back().front().stamp > last_) {
      std::vector<Item> line = std::move(candidates_.back());
      candidates_.pop_back();
      accepted = accept(std::move(line));
    }
    giveUp();
    return accepted;
  }

  /// Stamp of the newest image on the line; kNoStamp before the first.
  Stamp last() const { return last_; }

  /// The earliest stamp of the images that are held.
  std::optional<Stamp> earliestHeld() const {
    std::optional<Stamp> earliest;
    for (const auto& line : candidates_)
      earliest = std::min(earliest.value_or(line.front().stamp), line.front().stamp);
    return earliest;
  }

  const StreamCounts& counts() const { return counts_; }

  /// Forgets what it has seen, but for the counts.
  void reset() {
    candidates_.clear();
    last_ = kNoStamp;
  }

 private:
  Accepted hold(Item item) {
    const auto line =
        std::find_if(candidates_.begin(), candidates_.end(), [&](const std::vector<Item>& candidate) {
          return time_line::continues(candidate.back().stamp, item.stamp);
        });
    if (line == candidates_.end()) {
      if (candidates_.size() == time_line::kMostCandidates) {
        counts_.late += candidates_.front().size();
        candidates_.pop_front();
      }
      candidates_.emplace_back().push_back(std::move(item));
      return {};
    }
    line->push_back(std::move(item));
    if (line->size() < time_line::kConfirmations) return {};
    std::vector<Item> confirmed = std::move(*line);
    candidates_.erase(line);
    giveUp();
    return accept(std::move(confirmed));
  }

  Accepted accept(std::vector<Item> images) {
    std::optional<Stamp> line_before;
    if (images.front().stamp < last_) line_before = last_;
    last_ = images.back().stamp;
    counts_.accepted += images.size();
    return {std::move(images), line_before};
  }

  void giveUp() {
    for (const auto& line : candidates_) counts_.late += line.size();
    candidates_.clear();
  }

  std::deque<std::vector<Item>> candidates_;
  Stamp last_ = kNoStamp;
  StreamCounts counts_;
};

}  // namespace rgbd_sfm_fusion
