// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <utility>

#include "config_in_force.h"
#include "rgbd_sfm_fusion/ros/reconfigure_message.h"

namespace rgbd_sfm_fusion {

/// The settings that `stage` can change at run time, as a config. A value that cannot be used is refused with
/// a message, and the old values stay.
/// @tparam Config  generated from cfg/
template <class Config>
class SettingsInForce {
 public:
  /// @param apply  called with all settings after each change; where it throws, the old ones stay
  SettingsInForce(SettingScope stage, const Settings& settings, std::function<void(const Settings&)> apply)
      : settings_(settings),
        apply_(std::move(apply)),
        config_(toConfig(settings, stage), [this](Config& config) { use(config); }) {}
  SettingsInForce(const SettingsInForce&) = delete;
  SettingsInForce& operator=(const SettingsInForce&) = delete;

  ConfigInForce<Config>& config() { return config_; }

 private:
  static Config toConfig(const Settings& settings, SettingScope stage) {
    dynamic_reconfigure::Config message = toReconfigureMessage(settings, stage);
    Config config = Config::__getDefault__();
    config.__fromMessage__(message);
    return config;
  }

  void use(const Config& config) {
    dynamic_reconfigure::Config message;
    config.__toMessage__(message);
    Settings changed = settings_;
    applyReconfigureMessage(message, &changed);
    apply_(changed);
    settings_ = changed;
  }

  Settings settings_;
  std::function<void(const Settings&)> apply_;
  ConfigInForce<Config> config_;
};

/// Dynamic reconfigure of them.
template <class Config>
class Reconfiguration {
 public:
  /// @param mutex     held while the server calls; of whatever else `apply` changes
  /// @param settings  in force, with what the parameters say: the server alone would not know what a preset
  ///                  has set
  /// @param apply     called with all settings at once, and after each change
  Reconfiguration(const ros::NodeHandle& private_handle, boost::recursive_mutex& mutex, SettingScope stage,
                  const Settings& settings, std::function<void(const Settings&)> apply)
      : settings_(stage, settings, std::move(apply)),
        server_(private_handle, mutex, &settings_.config(), false) {}

 private:
  SettingsInForce<Config> settings_;
  ReconfigureServer<Config> server_;
};

}  // namespace rgbd_sfm_fusion
