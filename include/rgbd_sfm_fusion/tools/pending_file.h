// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace rgbd_sfm_fusion {

/// A file that appears under its name only when it is complete. It is written as `<path>.partial` beside it,
/// and renamed by commit(). If commit() is never called, the destructor removes it. If two processes write
/// the same file, the second one is refused. If `path` is a symbolic link, its target is written.
class PendingFile {
 public:
  /// Creates the temporary file at once, so that an unusable path is known before any work.
  /// @throws std::runtime_error naming the path and the reason, e.g. that it is no file, or that
  ///         `<path>.partial` exists already. An existing one is never touched
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

  /// Call this when the temporary file is closed. Replaces what was there under the name.
  /// @throws std::runtime_error naming the path and the reason
  void commit();

 private:
  std::string path_;
  std::string target_;  ///< `path_`, without symbolic links
  std::string temporary_path_;
  int lock_ = -1;  ///< descriptor of the temporary file; its lock tells others that the file is being written
  bool committed_ = false;
};

/// A folder. The destructor removes it if it was made here and keep() was not called.
class PendingFolder {
 public:
  enum class Existing {
    kAccept,  ///< others may write there, too: the folder is removed only if it is empty
    kRefuse,  ///< it is ours alone: it is removed with all that is in it
  };

  /// Makes the folder, and those that it is in.
  /// @throws std::runtime_error naming the path and the reason
  PendingFolder(std::string path, Existing existing);
  ~PendingFolder();

  PendingFolder(const PendingFolder&) = delete;
  PendingFolder& operator=(const PendingFolder&) = delete;

  const std::string& path() const { return path_; }
  void keep() { made_ = false; }

 private:
  std::string path_;
  Existing existing_;
  bool made_ = false;
};

/// @throws std::runtime_error if writing `output` would replace one of `inputs`, under whatever name
void requireNoInput(const std::string& output, const std::vector<std::string>& inputs);

}  // namespace rgbd_sfm_fusion
