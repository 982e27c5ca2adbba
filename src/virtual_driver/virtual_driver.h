// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "driver_context.h"
#include "virtual_device.h"

namespace rgbd_sfm_fusion {

/// OpenNI2 driver of one virtual device, which comes and goes as the settings say. Each time it is plugged in
/// it has another URI, as USB devices have.
class VirtualDriver : public oni::driver::DriverBase {
 public:
  explicit VirtualDriver(OniDriverServices* services) : DriverBase(services) {}
  ~VirtualDriver() override { stopPlugging(); }

  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback state_changed, void* cookie) override;
  void shutdown() override { stopPlugging(); }

  oni::driver::DeviceBase* deviceOpen(const char* uri, const char* mode) override;
  void deviceClose(oni::driver::DeviceBase* device) override;

  /// Always on: images of one instant have the same time stamp anyway.
  void* enableFrameSync(oni::driver::StreamBase**, int) override { return this; }
  void disableFrameSync(void*) override {}

 private:
  void plugIn();
  void unplug();
  void runPlugging();
  void stopPlugging();
  void complain(const std::string& what);

  std::unique_ptr<DriverContext> context_;
  std::thread plugging_;

  std::mutex mutex_;  ///< guards what follows; never held during a call of OpenNI2
  std::condition_variable stop_;
  bool stopping_ = false;
  bool plugged_ = false;
  int plug_count_ = 0;
  OniDeviceInfo info_ = {};
  SteadyClock::time_point plugged_at_;
  std::vector<std::unique_ptr<VirtualDevice>> devices_;  ///< open devices; all but the last are unplugged
};

}  // namespace rgbd_sfm_fusion
