// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/camera/camera_clock.h"

#include <algorithm>
#include <cmath>

namespace rgbd_sfm_fusion {
namespace {

constexpr Stamp kNanosecondsPerMicrosecond = 1000;

double secondsBetween(std::int64_t from, std::int64_t to) {
  return 1e-6 * static_cast<double>(to - from);
}

}  // namespace

Stamp CameraClock::toHost(std::uint64_t device_time, Stamp arrival) {
  const auto device = static_cast<std::int64_t>(device_time);
  const Stamp difference = arrival - device * kNanosecondsPerMicrosecond;
  if (!state_) start(device, difference);
  double raw = toSeconds(difference - state_->base);
  if (hasJumped(device, raw)) {
    ++jumps_;
    start(device, difference);
    raw = 0.0;
  }
  advance(device, raw);
  return device * kNanosecondsPerMicrosecond + state_->base +
         static_cast<Stamp>(std::llround(1e9 * state_->offset));
}

void CameraClock::start(std::int64_t device, Stamp base) {
  state_ = State();
  state_->start = state_->latest = state_->late_since = device;
  state_->base = base;
}

bool CameraClock::hasJumped(std::int64_t device, double raw) const {
  const bool device_restarted = secondsBetween(device, state_->latest) > options_.device_jump;
  const bool set_back = raw < state_->envelope - options_.host_jump;
  const bool is_late = raw > state_->envelope + options_.late_jump;
  const bool set_forward = is_late && secondsBetween(state_->late_since, device) > options_.late_time;
  return device_restarted || set_back || set_forward;
}

void CameraClock::advance(std::int64_t device, double raw) {
  State& state = *state_;
  // A frame of another stream may have been taken at the same time or later: then no time has passed.
  const double passed = std::max(0.0, secondsBetween(state.latest, device));
  state.latest = std::max(state.latest, device);
  state.envelope = std::min(raw, state.envelope + options_.max_drift * passed);
  if (raw <= state.envelope + options_.late_jump) state.late_since = std::max(state.late_since, device);

  const bool settling = secondsBetween(state.start, state.latest) < options_.settling_time;
  const double step = (settling ? options_.settling_slew : options_.slew) * passed;
  state.offset += std::clamp(state.envelope - state.offset, -step, step);
}

}  // namespace rgbd_sfm_fusion
