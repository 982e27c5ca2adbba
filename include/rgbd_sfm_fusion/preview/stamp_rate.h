// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <deque>
#include <limits>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Frames per second by their stamps, so the same live and offline. Dropped frames lower the rate.
class StampRate {
 public:
  void add(Stamp stamp) {
    if (!stamps_.empty() && stamp <= stamps_.back()) stamps_.clear();  // time starts anew
    stamps_.push_back(stamp);
    while (stamps_.size() > kFewest && stamps_.back() - stamps_.front() > kWindow) stamps_.pop_front();
  }

  /// [Hz] over the last second; NaN before the second frame.
  double rate() const {
    if (stamps_.size() < 2) return std::numeric_limits<double>::quiet_NaN();
    return static_cast<double>(stamps_.size() - 1) / toSeconds(stamps_.back() - stamps_.front());
  }

 private:
  static constexpr std::size_t kFewest = 2;
  static constexpr Stamp kWindow = 1'000'000'000;  // [ns]

  std::deque<Stamp> stamps_;
};

}  // namespace rgbd_sfm_fusion
