// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

#include "timeline.h"

namespace rgbd_sfm_fusion {

/// Lists the frames that were delivered, so that results can be compared with the truth. Every colour image
/// gets a line `index device_us host_ns`; the last number is the host's time of day when the image was due.
class FrameLog {
 public:
  /// @param path empty for no log
  /// @throws std::invalid_argument naming the file that can't be written
  explicit FrameLog(const std::string& path);

  /// @param device_time [us]
  void add(std::uint32_t index, std::uint64_t device_time, SteadyClock::time_point due);

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace rgbd_sfm_fusion
