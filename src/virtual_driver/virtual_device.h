// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "driver_context.h"
#include "frame_source.h"
#include "stream_format.h"
#include "virtual_stream.h"

namespace rgbd_sfm_fusion {

/// The open virtual device.
class VirtualDevice : public oni::driver::DeviceBase {
 public:
  VirtualDevice(DriverContext& context, SteadyClock::time_point plugged_at);

  /// Takes the lock that the settings name.
  /// @return false if another process has it
  bool lock();

  void unplug() { source_.unplug(); }

  OniStatus getSensorInfoList(OniSensorInfo** infos, int* count) override;
  oni::driver::StreamBase* createStream(OniSensorType sensor) override;
  void destroyStream(oni::driver::StreamBase* stream) override;

  OniBool isPropertySupported(int property) override;
  OniStatus getProperty(int property, void* data, int* size) override;
  OniStatus setProperty(int property, const void* data, int size) override;
  OniBool isImageRegistrationModeSupported(OniImageRegistrationMode mode) override;

 private:
  /// A file descriptor.
  class LockFile {
   public:
    ~LockFile();
    bool take(const std::string& path);

   private:
    int descriptor_ = -1;
  };

  DriverContext& context_;
  LockFile lock_;
  SensorModes modes_;
  FrameSource source_;
  std::vector<std::unique_ptr<VirtualStream>> streams_;
};

}  // namespace rgbd_sfm_fusion
