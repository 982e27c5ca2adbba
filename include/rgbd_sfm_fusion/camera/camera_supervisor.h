// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "rgbd_sfm_fusion/camera/camera_session.h"

namespace rgbd_sfm_fusion {

struct CameraStatus {
  enum class State { kWaiting, kReady, kStreaming };
  struct Stream {
    std::uint64_t frames = 0;
    std::uint64_t dropped = 0;  ///< frames, by the device's own count
    bool running = false;
  };

  State state = State::kWaiting;
  std::string problem;       ///< the latest one since the wishes last changed
  DeviceDescription device;  ///< the latest
  PerStream<Stream> streams;
  int connections = 0;  ///< how often a device was opened
};

/// Keeps a camera running, in a thread of its own. Waits for the device, opens it, starts the wanted streams,
/// and does all of that again after the device was unplugged or has stalled. Only that thread waits for
/// hardware, and the destructor waits for that thread.
class CameraSupervisor {
 public:
  enum class Severity { kInfo, kWarning, kError };

  struct Options {
    std::string device_id;         ///< see selectDevices()
    double retry_delay = 0.25;     ///< [s] before the first new try; doubles with each try
    double max_retry_delay = 5.0;  ///< [s] a device that is plugged in meanwhile is opened at once
    double repeat_after = 30.0;    ///< [s] after which the same problem is reported again
    CameraSession::Options session;
  };

  /// Called by the supervisor's thread.
  struct Callbacks {
    std::function<void(const DeviceDescription&)> opened;
    std::function<void(const CameraFrame&)> frame;
    std::function<void(Severity, const std::string&)> say;
  };

  CameraSupervisor(const Options& options, const CameraSettings& settings, Callbacks callbacks);
  ~CameraSupervisor();

  /// May be called from any thread, like all that follow.
  void setWanted(const PerStream<bool>& wanted);
  void setSettings(const CameraSettings& settings);
  CameraStatus status() const;

 private:
  void run();
  void runSession();
  void deliver(const CameraFrame& frame);
  void waitBeforeRetry(double delay, std::uint64_t changes_before);
  void updateStatus(const CameraSession& session);
  void report(Severity severity, const std::string& problem);
  bool isStopping() const;

  Options options_;
  Callbacks callbacks_;

  mutable std::mutex mutex_;  ///< never held while callbacks run
  std::condition_variable change_;
  bool stopping_ = false;
  PerStream<bool> wanted_;
  CameraSettings settings_;
  CameraStatus status_;

  // Used only by the supervisor's thread.
  std::shared_ptr<OpenNiLibrary> library_;
  PerStream<int> last_index_;
  bool has_delivered_ = false;
  bool frame_sync_failed_ = false;
  std::string last_problem_;
  std::chrono::steady_clock::time_point last_said_;

  std::thread thread_;
};

}  // namespace rgbd_sfm_fusion
