// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "driver_settings.h"

namespace rgbd_sfm_fusion {

using SteadyClock = std::chrono::steady_clock;

inline SteadyClock::duration seconds(double value) {
  return std::chrono::duration_cast<SteadyClock::duration>(std::chrono::duration<double>(value));
}

/// When each frame is due. From the first start of a stream on, frames follow each other at the camera's
/// rate, whether anybody reads them or not. A frame that nobody reads is lost.
class Timeline {
 public:
  /// @param index of the frame at `origin`
  Timeline(SteadyClock::time_point origin, double rate, std::uint32_t first_index)
      : origin_(origin), rate_(rate), first_index_(first_index) {}

  SteadyClock::time_point instantOf(std::uint32_t index) const {
    return origin_ + seconds((index - first_index_) / rate_);
  }

  /// The first frame that is due at `time` or later.
  std::uint32_t indexFrom(SteadyClock::time_point time) const;

 private:
  SteadyClock::time_point origin_;
  double rate_;
  std::uint32_t first_index_;
};

/// The device's own clock, which starts when it gets power.
class DeviceClock {
 public:
  DeviceClock(const DriverSettings& settings, SteadyClock::time_point plugged_at)
      : plugged_at_(plugged_at), offset_(settings.clock_offset), rate_(1.0 + settings.clock_drift) {}

  /// [us]
  std::uint64_t at(SteadyClock::time_point time) const;

 private:
  SteadyClock::time_point plugged_at_;
  double offset_;
  double rate_;
};

}  // namespace rgbd_sfm_fusion
