// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dynamic_reconfigure/server.h>
#include <ros/console.h>

#include <boost/thread/recursive_mutex.hpp>
#include <functional>
#include <stdexcept>
#include <utility>

#include "rgbd_sfm_fusion/ros/reconfigure_message.h"

namespace rgbd_sfm_fusion {

/// Dynamic reconfigure of the settings that `stage` can tune at run time. A value that can't be used is
/// refused with a message, and the old ones stay.
/// @tparam Config  generated from cfg/
template <class Config>
class Reconfiguration {
 public:
  /// @param mutex  held while the server calls; of whatever else `apply` changes
  /// @param apply  called with all settings after each change
  Reconfiguration(const ros::NodeHandle& private_handle, boost::recursive_mutex& mutex, SettingScope stage,
                  const Settings& settings, std::function<void(const Settings&)> apply)
      : stage_(stage), settings_(settings), apply_(std::move(apply)), server_(mutex, private_handle) {
    // The parameters have been read; the server alone would not know what a preset has set.
    server_.updateConfig(currentConfig());
    server_.setCallback([this](Config& config, std::uint32_t) { change(&config); });
  }

 private:
  Config currentConfig() const {
    dynamic_reconfigure::Config message = toReconfigureMessage(settings_, stage_);
    Config config = Config::__getDefault__();
    config.__fromMessage__(message);
    return config;
  }

  void change(Config* config) {
    dynamic_reconfigure::Config message;
    config->__toMessage__(message);
    try {
      applyReconfigureMessage(message, &settings_);
      apply_(settings_);
    } catch (const std::invalid_argument& error) {
      ROS_ERROR_STREAM("refused: " << error.what());
      *config = currentConfig();
    }
  }

  SettingScope stage_;
  Settings settings_;
  std::function<void(const Settings&)> apply_;
  dynamic_reconfigure::Server<Config> server_;
};

}  // namespace rgbd_sfm_fusion
