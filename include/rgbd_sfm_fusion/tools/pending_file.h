// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace rgbd_sfm_fusion {

/// A file that appears under its name only when it is complete: it is written as `<path>.partial` beside it,
/// renamed by commit(), and removed by the destructor if that never came.
class PendingFile {
 public:
  /// Creates the temporary file, so that a path that can't be written is known before any work.
  /// @throws std::runtime_error naming the path and the reason
  explicit PendingFile(const std::string& path);
  /// @param temporary_path  instead of `<path>.partial`, on the same file system: for writers that choose the
  ///                        format by the name's ending
  PendingFile(std::string path, std::string temporary_path);
  ~PendingFile();

  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  const std::string& path() const { return path_; }
  /// Where to write.
  const std::string& temporaryPath() const { return temporary_path_; }

  /// Call when the temporary file is closed. Replaces what was there under the name.
  /// @throws std::runtime_error naming the path and the reason
  void commit();

 private:
  std::string path_;
  std::string temporary_path_;
  bool committed_ = false;
};

}  // namespace rgbd_sfm_fusion
