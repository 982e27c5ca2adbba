// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace rgbd_sfm_fusion {

/// OpenNI2, loaded and initialised once per process, for as long as anybody holds a reference.
class OpenNiLibrary {
 public:
  /// Takes as long as the drivers need to look for devices.
  /// @throws CameraError naming the folder that was searched, if there is no driver
  static std::shared_ptr<OpenNiLibrary> acquire();
  ~OpenNiLibrary();

  /// Devices that are plugged in.
  std::vector<std::string> uris() const;

  /// Rises with each device that comes, goes or fails.
  std::uint64_t changes() const { return changes_; }

  /// How often the device went or failed.
  std::uint64_t disconnections(const std::string& uri) const;

  /// OpenNI2's own message about the last failure in this thread.
  static std::string lastError();

  /// Whether the libOpenNI2 in use is the one that was asked for.
  /// @param folder  that should hold libOpenNI2.so.0
  /// @return empty if it is; else a text: which one is used instead, why, and the cure
  static std::string whyNotFrom(const std::string& folder);

  /// Where this libOpenNI2 looks for drivers, unless its OpenNI.ini names another folder.
  static std::string driverFolder();

 private:
  class Listener;

  OpenNiLibrary();
  void disconnected(const std::string& uri);

  std::atomic<std::uint64_t> changes_{0};
  mutable std::mutex mutex_;
  std::map<std::string, std::uint64_t> disconnections_;
  std::unique_ptr<Listener> listener_;
};

}  // namespace rgbd_sfm_fusion
