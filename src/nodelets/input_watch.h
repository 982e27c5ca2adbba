// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace rgbd_sfm_fusion {

/// Says which topics have been silent for five seconds, and whether anybody publishes them: most trouble at
/// the start is a name. In wall time, since /clock may be what is missing.
class InputWatch {
 public:
  struct Topic {
    std::string name;
    std::string consequence;  ///< e.g. `nothing is tracked`
    std::function<std::uint32_t()> publishers;
    std::size_t received = 0;  ///< since the last look
  };

  InputWatch(const ros::NodeHandle& handle, std::string owner);

  /// @return index for received()
  std::size_t add(const std::string& name, const std::string& consequence,
                  std::function<std::uint32_t()> publishers);
  void received(std::size_t topic) { ++topics_[topic].received; }

 private:
  void look();

  std::string owner_;
  std::vector<Topic> topics_;
  ros::NodeHandle handle_;
  ros::WallTimer timer_;
};

}  // namespace rgbd_sfm_fusion
