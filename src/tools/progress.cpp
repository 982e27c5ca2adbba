// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tools/progress.h"

#include <unistd.h>

#include <cmath>
#include <iomanip>
#include <iostream>
#include <locale>
#include <sstream>

namespace rgbd_sfm_fusion {
namespace {

constexpr std::chrono::milliseconds kPeriod{200};

}  // namespace

Progress::Progress(std::size_t total)
    : total_(total),
      is_terminal_(isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()),
      last_(start_ - kPeriod) {}

Progress::~Progress() {
  if (shown_) std::cerr << '\n';
}

void Progress::show(std::size_t done) {
  const auto now = std::chrono::steady_clock::now();
  if (!is_terminal_ || (now - last_ < kPeriod && done < total_)) return;
  last_ = now;
  shown_ = true;
  const std::chrono::duration<double> elapsed = now - start_;
  std::cerr << "\r\033[K" << progressText(done, total_, elapsed.count()) << std::flush;
}

std::string progressText(std::size_t done, std::size_t total, double elapsed_seconds) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << done << '/' << total << " frames";
  if (done == 0 || total == 0 || !(elapsed_seconds > 0.0)) return text.str();
  const double rate = static_cast<double>(done) / elapsed_seconds;
  const double left = static_cast<double>(total > done ? total - done : 0) / rate;
  const auto seconds = static_cast<long>(std::ceil(left));
  text << " (" << 100 * done / total << " %), " << std::fixed << std::setprecision(1) << rate
       << " per second, " << seconds / 60 << ':' << std::setw(2) << std::setfill('0') << seconds % 60
       << " left";
  return text.str();
}

}  // namespace rgbd_sfm_fusion
