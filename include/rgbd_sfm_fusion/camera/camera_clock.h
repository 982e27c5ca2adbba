// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Maps a device's own clock to the host's. A frame arrives some time after it was taken: never earlier than
/// the shortest delivery takes, often later. So the lower envelope of (arrival - device time) is the offset
/// between the two clocks plus that shortest delivery, which a fixed offset must correct. The envelope
/// follows an earlier arrival at once, and rises by at most `max_drift`, so late arrivals do not move it.
///
/// Stamps follow the envelope at a bounded speed. Within a stream they rise as the device's do, and never
/// jump, except after a reset. All streams of a device share one clock: equal device times get equal stamps.
class CameraClock {
 public:
  struct Options {
    double max_drift = 2e-4;  ///< [s/s] at most, between two crystals
    double settling_time =
        2.0;  ///< [s of device time] in which stamps follow fast, since the first arrivals may have been late
    double settling_slew = 0.2;  ///< [s/s] at most, of stamps towards the envelope during that time
    double slew = 0.01;          ///< [s/s] the same afterwards
    double host_jump = 0.25;     ///< [s] so far below the envelope, the host's clock was set back
    double late_jump = 0.1;      ///< [s] if all arrivals of late_time are later than this, a clock was set
    double late_time = 2.0;      ///< [s]
    double device_jump = 1.0;    ///< [s] if the device's clock goes back by more, the device has started anew
  };

  CameraClock() = default;
  explicit CameraClock(const Options& options) : options_(options) {}

  /// @param device_time  [us] of the frame, from any zero
  /// @param arrival      [ns] of the host's clock
  /// @return [ns] the time at which the frame was taken, plus the time of the shortest delivery
  Stamp toHost(std::uint64_t device_time, Stamp arrival);

  /// Forgets everything. For use after a reconnection.
  void reset() { state_.reset(); }

  /// How often the model was started anew because one of the clocks jumped.
  int jumps() const { return jumps_; }

 private:
  struct State {
    std::int64_t start = 0;       ///< [us] device time of the first frame
    std::int64_t latest = 0;      ///< [us] latest device time
    double envelope = 0.0;        ///< [s] relative to `base`
    double offset = 0.0;          ///< [s] added to make stamps; follows the envelope
    Stamp base = 0;               ///< [ns] host's clock minus device's clock, at the first frame
    std::int64_t late_since = 0;  ///< [us] device time of the last arrival that was not late
  };

  void start(std::int64_t device, Stamp base);
  bool hasJumped(std::int64_t device, double raw) const;
  void advance(std::int64_t device, double raw);

  Options options_;
  std::optional<State> state_;
  int jumps_ = 0;
};

}  // namespace rgbd_sfm_fusion
