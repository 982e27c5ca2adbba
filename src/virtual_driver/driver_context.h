// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <mutex>
#include <optional>

#include "driver_settings.h"
#include "frame_log.h"
#include "timeline.h"

namespace rgbd_sfm_fusion {

/// State that outlasts an unplugged device: settings, log, and when each frame is due.
class DriverContext {
 public:
  /// @throws std::invalid_argument saying what is wrong with the settings
  explicit DriverContext(const DriverSettings& settings);

  const DriverSettings& settings() const { return settings_; }
  FrameLog& log() { return log_; }

  SteadyClock::time_point afterLoad(double time) const { return loaded_at_ + seconds(time); }

  /// Whether this start of a stream shall fail. Counts down how many more shall.
  bool startFails() { return failing_starts_.fetch_sub(1) > 0; }

  /// The timeline begins with the first call.
  const Timeline& timeline();

 private:
  const DriverSettings settings_;
  SteadyClock::time_point loaded_at_;
  FrameLog log_;
  std::atomic<int> failing_starts_;
  std::once_flag begun_;
  std::optional<Timeline> timeline_;
};

}  // namespace rgbd_sfm_fusion
