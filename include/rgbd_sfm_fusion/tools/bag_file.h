// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Reads bags (format 2.0: https://wiki.ros.org/Bags/Format/2.0) that may be damaged: every length, position
/// and count is checked before it is used, which librosbag does not do. Whatever the file claims, it takes
/// some MB of memory at most, plus 16 bytes for each message, plus a compressed chunk.
class BagFile {
 public:
  struct Connection {
    std::string topic;
    std::string type;    ///< e.g. sensor_msgs/Image
    std::string md5sum;  ///< of the definition of the type
  };

  /// Where a message is.
  struct Entry {
    Stamp time = 0;  ///< [ns] when it was recorded
    std::uint32_t chunk = 0;
    std::uint32_t offset = 0;  ///< [bytes] into the chunk's uncompressed data
  };

  /// Reads the index.
  /// @throws std::runtime_error naming the file, what is wrong with it, and the cure where there is one
  explicit BagFile(const std::string& path);
  ~BagFile();

  const std::vector<Connection>& connections() const { return connections_; }

  /// Messages of a connection, in order of time.
  const std::vector<Entry>& entries(std::size_t connection) const { return entries_.at(connection); }

  /// The message as it was sent.
  /// @throws std::runtime_error naming the file and the place where it is damaged
  std::vector<std::uint8_t> read(std::size_t connection, const Entry& entry);

 private:
  class Chunks;

  std::string path_;
  std::unique_ptr<Chunks> chunks_;
  std::vector<Connection> connections_;
  std::vector<std::uint32_t> ids_;  ///< the file's numbers of the connections
  std::vector<std::vector<Entry>> entries_;
};

}  // namespace rgbd_sfm_fusion
