// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fstream>
#include <string>

#include "rgbd_sfm_fusion/tools/pending_file.h"

namespace rgbd_sfm_fusion {

/// A text file that appears under its name only when it is complete.
class ResultFile {
 public:
  /// @throws std::runtime_error naming the path and the reason
  explicit ResultFile(const std::string& path);

  /// @throws std::runtime_error when it can't be written, e.g. when the disk is full
  void write(const std::string& text);
  /// @throws as write(), as the disk may be full
  void close();
  void commit() { file_.commit(); }

 private:
  void check();

  PendingFile file_;
  std::ofstream stream_;
};

}  // namespace rgbd_sfm_fusion
