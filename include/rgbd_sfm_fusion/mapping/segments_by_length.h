// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "rgbd_sfm_fusion/mapping/epipolar_segments.h"

namespace rgbd_sfm_fusion {

/// Segments that are searched side by side, and which of all segments each of them is.
struct SearchBlock {
  SegmentBlock segments;
  int number[kLanes];
  std::size_t count = 0;  ///< behind these, lanes repeat the last one

  /// A full block was handed out.
  std::size_t waiting() const { return count % kLanes; }
};

/// Puts segments of one length together as they come, since those of a block are searched as long as the
/// longest of them.
class SegmentsByLength {
 public:
  /// @param longest  [px] before + after of the longest segment
  void setLongest(int longest) { blocks_.resize(static_cast<std::size_t>(longest) + 1); }

  /// Takes one lane of a block. @return a block that is full now; null: there is none. It has to be searched
  /// before the next call.
  const SearchBlock* add(const SegmentBlock& from, std::size_t lane, int number) {
    const auto length = static_cast<std::size_t>(from.before[lane] + from.after[lane]);
    return append(from, lane, number, blocks_[length]);
  }

  /// Takes out the rest: calls `search(block)` for blocks of segments of similar length.
  template <class Search>
  void empty(const Search& search) {
    for (SearchBlock& block : blocks_) {
      for (std::size_t lane = 0; lane < block.waiting(); ++lane) {
        if (const SearchBlock* full = append(block.segments, lane, block.number[lane], rest_)) search(*full);
      }
      block.count = 0;
    }
    if (rest_.waiting() > 0) {
      fillUp(rest_);
      search(rest_);
    }
    rest_.count = 0;
  }

 private:
  static void fillUp(SearchBlock& block);
  static const SearchBlock* append(const SegmentBlock& from, std::size_t lane, int number, SearchBlock& to);

  std::vector<SearchBlock> blocks_;  // per length, those that wait for more
  SearchBlock rest_;
};

}  // namespace rgbd_sfm_fusion
