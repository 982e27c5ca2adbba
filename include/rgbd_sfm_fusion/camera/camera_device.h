// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "rgbd_sfm_fusion/camera/camera_types.h"
#include "rgbd_sfm_fusion/camera/openni_library.h"

namespace rgbd_sfm_fusion {

/// An opened device. Make all calls from one thread: if threads share a device, OpenNI2 drops frames, or does
/// worse.
class CameraDevice {
 public:
  /// @throws CameraError with the likely reason
  CameraDevice(std::shared_ptr<OpenNiLibrary> library, const std::string& uri);
  ~CameraDevice();

  const DeviceDescription& description() const { return description_; }

  /// True after the device was unplugged, or its driver gave it up.
  bool isLost() const { return library_->disconnections(description_.uri) != disconnections_; }

  /// @throws CameraError when the device has no such stream or mode, or its driver fails
  void start(StreamKind stream, const StreamMode& mode);
  void stop(StreamKind stream);
  bool isRunning(StreamKind stream) const { return running_[stream]; }

  /// Waits for a frame of any running stream. Its image is valid until the next call of any function here.
  /// @return nothing if no frame came in time
  /// @throws CameraError for a frame in another format than the one asked for
  std::optional<CameraFrame> read(std::chrono::milliseconds timeout);

  /// Settings. Each throws CameraError if the device refuses it.
  void setRegistration(bool on);
  void setFrameSync(bool on);
  void setMirror(StreamKind stream, bool on);
  void setExposure(const CameraSettings& settings);

  bool isRegistered() const { return registered_; }

 private:
  struct Handles;

  void describe();
  void enableFrameSync(bool on);

  std::shared_ptr<OpenNiLibrary> library_;
  std::unique_ptr<Handles> handles_;
  DeviceDescription description_;
  std::uint64_t disconnections_ = 0;
  PerStream<bool> running_;
  bool registered_ = false;
  bool synchronised_ = false;
  cv::Mat converted_;  ///< holds frames that come in another format than the one that we hand out
};

/// Opens the device that `selector` names, see selectDevices().
/// @throws CameraError
std::unique_ptr<CameraDevice> openCamera(const std::shared_ptr<OpenNiLibrary>& library,
                                         const std::string& selector);

}  // namespace rgbd_sfm_fusion
