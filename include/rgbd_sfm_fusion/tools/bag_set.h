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

/// Several bags as if they were one: parts of a recording that was split, or colour in one and depth in
/// another. Messages come in the order in which they were recorded, as 'rosbag play' has it.
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

  /// In order of time; of the same time in the order of the bags.
  std::vector<Place> places(const std::vector<std::size_t>& connections) const;

  /// @throws std::runtime_error as BagFile::read()
  std::vector<std::uint8_t> read(const Place& place);

  /// For messages about all: the path, or the first of the paths and how many more.
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
