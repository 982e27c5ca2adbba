// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "timeline.h"

#include <algorithm>
#include <cmath>

namespace rgbd_sfm_fusion {
namespace {

double inSeconds(SteadyClock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

std::uint32_t Timeline::indexFrom(SteadyClock::time_point time) const {
  const double frames = std::max(0.0, inSeconds(time - origin_) * rate_);
  return first_index_ + static_cast<std::uint32_t>(std::ceil(frames - 1e-6));
}

std::uint64_t DeviceClock::at(SteadyClock::time_point time) const {
  const double shown = offset_ + rate_ * inSeconds(time - plugged_at_);
  return static_cast<std::uint64_t>(std::llround(1e6 * std::max(0.0, shown)));
}

}  // namespace rgbd_sfm_fusion
