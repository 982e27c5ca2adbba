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

/// All callbacks of a nodelet run inside this guard: one at a time, and none before the nodelet is complete.
/// If a callback throws, the guard logs what was thrown and where it came from, and stops it there.
///
/// A manager's threads call back as soon as there is a subscription. Therefore onInit() holds lock() until
/// everything is made.
class CallbackGuard {
 public:
  using Lock = boost::recursive_mutex::scoped_lock;

  /// @param owner  name of the nodelet, for the log
  explicit CallbackGuard(std::string owner) : owner_(std::move(owner)) {}

  /// Sets who else is told what went wrong, e.g. diagnostics.
  void setFailureHandler(std::function<void(const std::string&)> handler) { handler_ = std::move(handler); }

  /// While this is held, no callback runs.
  Lock lock() { return Lock(mutex_); }

  /// For a dynamic_reconfigure::Server, which must hold it while it calls.
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

  /// Wraps a callback for messages of a topic so that it runs inside the guard.
  template <class Message, class Function>
  boost::function<void(const boost::shared_ptr<const Message>&)> forMessages(const std::string& topic,
                                                                             Function function) {
    return [this, topic, function](const boost::shared_ptr<const Message>& message) {
      run(topic, [&] { function(message); });
    };
  }

  /// Wraps the callback of a timer, or another one without arguments, in the same way.
  template <class Event, class Function>
  boost::function<void(const Event&)> forEvents(const std::string& source, Function function) {
    return [this, source, function](const Event&) { run(source, function); };
  }

  /// Logs what is wrong with what came from `source`. The same text is repeated after five seconds at the
  /// earliest, another text after one second.
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
