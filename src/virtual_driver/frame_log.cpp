// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "frame_log.h"

#include <cerrno>
#include <chrono>
#include <cinttypes>
#include <cstring>
#include <stdexcept>

namespace rgbd_sfm_fusion {

FrameLog::FrameLog(const std::string& path) {
  if (path.empty()) return;
  file_.reset(std::fopen(path.c_str(), "w"));
  if (file_ == nullptr) throw std::invalid_argument("log=" + path + ": " + std::strerror(errno));
  std::setvbuf(file_.get(), nullptr, _IOLBF, BUFSIZ);  // every line is whole, whatever ends the process
  std::fputs("# index device_us host_ns\n", file_.get());
}

void FrameLog::add(std::uint32_t index, std::uint64_t device_time, SteadyClock::time_point due) {
  if (file_ == nullptr) return;
  using std::chrono::system_clock;
  const auto ago = SteadyClock::now() - due;
  const auto host_time = std::chrono::nanoseconds(system_clock::now().time_since_epoch() - ago).count();
  std::fprintf(file_.get(), "%" PRIu32 " %" PRIu64 " %" PRId64 "\n", index, device_time,
               static_cast<std::int64_t>(host_time));
}

}  // namespace rgbd_sfm_fusion
