// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "rgbd_sfm_fusion/camera/camera_clock.h"
#include "rgbd_sfm_fusion/camera/camera_device.h"

namespace rgbd_sfm_fusion {

/// One connection to a device, from opening to unplugging: starts and stops its streams, applies settings
/// once they run, stamps frames, and notices when they stop coming. For use by one thread.
class CameraSession {
 public:
  struct Options {
    double start_timeout = 10.0;  ///< [s] from a stream's start to its first frame
    double stall_timeout = 1.5;   ///< [s] between frames after that
    double sync_timeout = 1.5;    ///< [s] without a pair; then frame sync is given up
    double restart_delay = 1.0;   ///< [s] before a stream that did not start is tried again
  };

  using Report = std::function<void(const std::string&)>;

  /// @param report  called with what does not work while the rest goes on
  CameraSession(std::unique_ptr<CameraDevice> device, const Options& options, Report report);

  const DeviceDescription& description() const { return device_->description(); }
  bool isRunning(StreamKind stream) const { return device_->isRunning(stream); }
  bool isStreaming() const;

  /// Starts and stops streams as wanted; cheap if nothing has changed.
  /// @throws CameraError if the device is lost, or streams nothing although it should
  void update(const PerStream<bool>& wanted, const CameraSettings& settings);

  /// Waits for a frame.
  /// @throws CameraError if the device is lost, or a stream has stalled
  std::optional<CameraFrame> read(std::chrono::milliseconds timeout);

  /// Colour and depth both came, but not as pairs.
  bool hasFrameSyncFailed() const { return sync_ == Sync::kFailed; }

 private:
  using Time = std::chrono::steady_clock::time_point;

  enum class Sync { kOff, kWaiting, kWorks, kFailed };

  struct StreamState {
    bool has_delivered = false;
    Time last_frame;  ///< or of the start
    Time next_try;    ///< after a failed start, the next one is not before this
  };

  bool reconcileStreams(const PerStream<bool>& wanted, const CameraSettings& settings);
  bool start(StreamKind stream, const CameraSettings& settings);
  StreamMode chooseMode(StreamKind stream, const CameraSettings& settings) const;
  void applySettings(const CameraSettings& settings);
  void reportMode(StreamKind stream, const StreamMode& wanted) const;
  void applyFrameSync(const CameraSettings& settings);
  void checkStalls();
  void attempt(const std::function<void()>& setting) const;

  std::unique_ptr<CameraDevice> device_;
  Options options_;
  Report report_;
  CameraClock clock_;
  CameraSettings settings_;
  bool settings_are_new_ = true;
  PerStream<StreamState> streams_;
  PerStream<StreamMode> running_modes_;
  Sync sync_ = Sync::kOff;
  Time sync_start_;
};

}  // namespace rgbd_sfm_fusion
