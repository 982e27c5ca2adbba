// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>

#include <boost/function.hpp>
#include <boost/shared_ptr.hpp>
#include <boost/thread/recursive_mutex.hpp>
#include <functional>
#include <map>
#include <string>
#include <utility>

namespace rgbd_sfm_fusion {

/// What all callbacks of a nodelet run in: one at a time, none before the nodelet is whole, and whatever one
/// of them throws is said, with where it came from, and goes no further.
///
/// A manager's threads call as soon as there is a subscription. onInit() therefore holds lock() until all is
/// made.
class CallbackGuard {
 public:
  using Lock = boost::recursive_mutex::scoped_lock;

  /// @param owner  name of the nodelet, for the log
  explicit CallbackGuard(std::string owner) : owner_(std::move(owner)) {}

  /// Is told what went wrong, too: for diagnostics.
  void setFailureHandler(std::function<void(const std::string&)> handler) { handler_ = std::move(handler); }

  /// No callback runs while it is held.
  Lock lock() { return Lock(mutex_); }

  /// For a dynamic_reconfigure::Server, which has to hold it while it calls.
  boost::recursive_mutex& mutex() { return mutex_; }

  /// @param source  topic, service or timer
  template <class Function>
  void run(const std::string& source, Function&& function) noexcept {
    const Lock lock(mutex_);
    try {
      function();
    } catch (const std::exception& error) {
      report(source, error.what());
    } catch (...) {
      report(source, "something that is no std::exception was thrown");
    }
  }

  /// A callback of messages of a topic that runs in here.
  template <class Message, class Function>
  boost::function<void(const boost::shared_ptr<const Message>&)> forMessages(const std::string& topic,
                                                                             Function function) {
    return [this, topic, function](const boost::shared_ptr<const Message>& message) {
      run(topic, [&] { function(message); });
    };
  }

  /// A callback of a timer, or another one without anything to tell, that runs in here.
  template <class Event, class Function>
  boost::function<void(const Event&)> forEvents(const std::string& source, Function function) {
    return [this, source, function](const Event&) { run(source, function); };
  }

  /// Says what is wrong with what came from `source`: the same again after five seconds, something else after
  /// one.
  void report(const std::string& source, const std::string& reason) noexcept;

 private:
  std::string owner_;
  std::function<void(const std::string&)> handler_;
  boost::recursive_mutex mutex_;
  struct Said {
    std::string reason;
    ros::WallTime time;
  };
  std::map<std::string, Said> last_said_;  ///< by source
};

}  // namespace rgbd_sfm_fusion
