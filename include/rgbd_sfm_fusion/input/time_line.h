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

/// How many images of a stream were taken, and how many were left out and why.
struct StreamCounts {
  std::size_t accepted = 0;
  std::size_t late = 0;       ///< left out: a stamp before the last one, or a single stamp far ahead
  std::size_t repeated = 0;   ///< left out: the same stamp again
  std::size_t too_soon = 0;   ///< left out: too soon after the one before to be of use
  std::size_t unstamped = 0;  ///< left out: a stamp of 0, which is ROS's "no time"

  std::size_t leftOut() const { return late + repeated + too_soon + unstamped; }
};

namespace time_line {

constexpr Stamp kLongestStep = 10'000'000'000;  ///< [ns] a longer step has to be confirmed
constexpr std::size_t kConfirmations = 5;       ///< images that continue each other make a time line
constexpr std::size_t kMostCandidates = 4;

/// Whether `stamp` may be expected after `last`.
bool continues(Stamp last, Stamp stamp);

}  // namespace time_line

/// Orders the images of a stream by rising stamps, and leaves out images that do not fit.
///
/// An image may be stamped before the one before it, or far ahead. Such a stamp is either a slip (a message
/// was overtaken, a stamp is wrong), or the first of many (a bag loops, a clock was set). To find out, the
/// image is held, together with the images that continue it. If an image continues the old line, the held
/// images were a slip, and are left out. If kConfirmations images are held, they are the new line, and all of
/// them are given out. So a single stamp of 1970 or of next year changes nothing, a bag that loops loses
/// nothing, and no stamp makes all later images late for ever. If streams with different clocks are
/// interleaved, one of them is used.
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

  /// For the end of the stream. @return the held images that are ahead: nothing contradicts them any more
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

  /// The earliest stamp of the held images.
  std::optional<Stamp> earliestHeld() const {
    std::optional<Stamp> earliest;
    for (const auto& line : candidates_)
      earliest = std::min(earliest.value_or(line.front().stamp), line.front().stamp);
    return earliest;
  }

  const StreamCounts& counts() const { return counts_; }

  /// Forgets all images; the counts stay.
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
