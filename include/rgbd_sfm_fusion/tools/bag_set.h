// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "rgbd_sfm_fusion/tools/bag_file.h"

namespace rgbd_sfm_fusion {

/// Several bags read as one: the parts of a split recording, or colour in one bag and depth in another.
/// Messages come in the order of recording, as 'rosbag play' sends them.
class BagSet {
 public:
  /// A message.
  struct Place {
    std::size_t connection;
    BagFile::Entry entry;
  };

  /// @param paths  at least one
  /// @throws std::runtime_error as BagFile
  explicit BagSet(const std::vector<std::string>& paths);

  /// Connections of all bags; a topic may have several.
  const std::vector<BagFile::Connection>& connections() const { return connections_; }

  /// In order of time; messages of the same time in the order of the bags.
  std::vector<Place> places(const std::vector<std::size_t>& connections) const;

  /// @throws std::runtime_error as BagFile::read()
  std::vector<std::uint8_t> read(const Place& place);

  /// Names all bags in messages to people: the path, or the first path and how many more there are.
  const std::string& name() const { return name_; }

 private:
  struct Source {
    std::size_t bag;
    std::size_t connection;
  };

  std::string name_;
  std::vector<std::unique_ptr<BagFile>> bags_;
  std::vector<BagFile::Connection> connections_;
  std::vector<Source> sources_;  ///< of the connections
};

}  // namespace rgbd_sfm_fusion
