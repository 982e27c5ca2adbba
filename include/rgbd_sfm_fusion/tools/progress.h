// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace rgbd_sfm_fusion {

/// A line on the terminal (stderr) that says how far the work is and when it will be done. If stderr is no
/// terminal, nothing is written.
class Progress {
 public:
  explicit Progress(std::size_t total);
  /// Ends the line.
  ~Progress();

  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// @param done  of `total`
  void show(std::size_t done);

 private:
  std::size_t total_;
  bool is_terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_;
};

/// e.g. `120/360 frames (33 %), 28.4 per second, 0:08 left`
std::string progressText(std::size_t done, std::size_t total, double elapsed_seconds);

}  // namespace rgbd_sfm_fusion
