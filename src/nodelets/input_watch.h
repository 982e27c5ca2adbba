// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "callback_guard.h"

namespace rgbd_sfm_fusion {

/// Reports topics that have been silent for five seconds, and whether anybody publishes them: at the start, a
/// wrong name is the most common trouble. A topic that never came is reported again every half minute. A
/// topic that came and has ended is reported once. Uses wall time, since /clock may be the missing topic.
class InputWatch {
 public:
  InputWatch(const ros::NodeHandle& handle, CallbackGuard* guard, std::string owner);

  /// @param consequence  what the silence causes, e.g. `nothing is tracked`
  /// @param publishers   returns the topic's number of publishers
  /// @return index for received()
  std::size_t add(const std::string& name, const std::string& consequence,
                  std::function<std::uint32_t()> publishers);
  /// The same for a topic of which one message is enough: a calibration, which may be latched.
  std::size_t addNeededOnce(const std::string& name, const std::string& consequence,
                            std::function<std::uint32_t()> publishers);

  /// Call this within the guard.
  void received(std::size_t topic) { ++topics_[topic].received; }

 private:
  struct Topic {
    std::string name;
    std::string consequence;
    std::function<std::uint32_t()> publishers;
    bool is_needed_once = false;
    std::size_t received = 0;  ///< since the last look
    bool has_come = false;
    bool is_silent = false;
  };

  void look();
  std::string describe(const Topic& topic) const;

  std::string owner_;
  std::vector<Topic> topics_;
  std::size_t looks_ = 0;
  ros::NodeHandle handle_;
  ros::WallTimer timer_;
};

}  // namespace rgbd_sfm_fusion
