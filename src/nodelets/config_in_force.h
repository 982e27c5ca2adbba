// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dynamic_reconfigure/server.h>
#include <ros/console.h>

#include <boost/thread/recursive_mutex.hpp>
#include <exception>
#include <functional>
#include <memory>
#include <utility>

namespace rgbd_sfm_fusion {

/// A dynamic_reconfigure config that always shows what is in force, whatever is asked for and whatever goes
/// wrong.
template <class Config>
class ConfigInForce {
 public:
  /// @param config  in force at the start
  /// @param apply   puts a config in force, and may correct it first. If it throws, the config is refused;
  ///                 what was in force before must then still be so
  ConfigInForce(Config config, std::function<void(Config&)> apply)
      : config_(std::move(config)), apply_(std::move(apply)) {}

  const Config& operator*() const { return config_; }

  /// @param config  [in] asked for, [out] in force
  void change(Config* config) {
    Config wanted = *config;
    try {
      apply_(wanted);
      config_ = wanted;
    } catch (const std::exception& error) {
      ROS_ERROR_STREAM("refused: " << error.what() << "; nothing has changed");
    } catch (...) {
      ROS_ERROR("refused, for an unknown reason; nothing has changed");
    }
    *config = config_;
  }

 private:
  Config config_;
  std::function<void(Config&)> apply_;
};

/// Lets dynamic reconfigure show and change a config.
template <class Config>
class ReconfigureServer {
 public:
  /// @param mutex     held while the server calls: of whatever else a change of the config touches
  /// @param in_force  outlives the server
  /// @param from_parameters  whether to begin with what the parameters say, instead of what is in force
  ReconfigureServer(const ros::NodeHandle& private_handle, boost::recursive_mutex& mutex,
                    ConfigInForce<Config>* in_force, bool from_parameters) {
    // Requests come from other threads as soon as the server is there: they wait until it is whole.
    const boost::recursive_mutex::scoped_lock lock(mutex);
    server_ = std::make_unique<dynamic_reconfigure::Server<Config>>(mutex, private_handle);
    if (!from_parameters) server_->updateConfig(**in_force);
    server_->setCallback([in_force](Config& config, std::uint32_t) { in_force->change(&config); });
  }

 private:
  std::unique_ptr<dynamic_reconfigure::Server<Config>> server_;
};

}  // namespace rgbd_sfm_fusion
