// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "virtual_driver.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <stdexcept>
#include <string>

namespace rgbd_sfm_fusion {
namespace {

constexpr std::uint16_t kVendor = 0x2bc5, kProduct = 0x0401;  // Orbbec, Astra

DriverSettings settingsFromEnvironment() {
  const char* text = std::getenv(kSettingsVariable);
  return parseDriverSettings(text == nullptr ? "" : text);
}

OniDeviceInfo infoOf(int plug_count) {
  OniDeviceInfo info = {};
  std::snprintf(info.uri, sizeof info.uri, "%04x/%04x@virtual/%d", kVendor, kProduct, plug_count);
  std::snprintf(info.vendor, sizeof info.vendor, "rgbd_sfm_fusion");
  std::snprintf(info.name, sizeof info.name, "Virtual Astra");
  info.usbVendorId = kVendor;
  info.usbProductId = kProduct;
  return info;
}

}  // namespace

OniStatus VirtualDriver::initialize(oni::driver::DeviceConnectedCallback connected,
                                    oni::driver::DeviceDisconnectedCallback disconnected,
                                    oni::driver::DeviceStateChangedCallback state_changed, void* cookie) {
  const OniStatus status = DriverBase::initialize(connected, disconnected, state_changed, cookie);
  if (status != ONI_STATUS_OK) return status;
  try {
    context_ = std::make_unique<DriverContext>(settingsFromEnvironment());
  } catch (const std::exception& error) {
    complain(std::string(kSettingsVariable) + ": " + error.what());
    return ONI_STATUS_BAD_PARAMETER;
  }
  if (context_->settings().pluggedAtLoad()) plugIn();
  if (!context_->settings().plug_events.empty()) plugging_ = std::thread(&VirtualDriver::runPlugging, this);
  return ONI_STATUS_OK;
}

void VirtualDriver::complain(const std::string& what) {
  getServices().errorLoggerAppend("%s", what.c_str());
  // When OpenNI2 gives up a driver, it does not say why.
  std::fprintf(stderr, "virtual camera: %s\n", what.c_str());
}

oni::driver::DeviceBase* VirtualDriver::deviceOpen(const char* uri, const char* /*mode*/) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!plugged_ || std::string(info_.uri) != uri) {
    getServices().errorLoggerAppend("%s is not plugged in", uri);
    return nullptr;
  }
  auto device = std::make_unique<VirtualDevice>(*context_, plugged_at_);
  if (!device->lock()) {
    getServices().errorLoggerAppend("%s is in use by another process", uri);
    return nullptr;
  }
  devices_.push_back(std::move(device));
  return devices_.back().get();
}

void VirtualDriver::deviceClose(oni::driver::DeviceBase* device) {
  std::unique_ptr<VirtualDevice>
      closed;  // destroyed while the lock is not held, as its destructor joins a thread
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto same = [device](const auto& open) { return open.get() == device; };
  const auto at = std::find_if(devices_.begin(), devices_.end(), same);
  if (at == devices_.end()) return;
  closed = std::move(*at);
  devices_.erase(at);
}

void VirtualDriver::plugIn() {
  OniDeviceInfo info;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    info = info_ = infoOf(++plug_count_);
    plugged_ = true;
    plugged_at_ = SteadyClock::now();
  }
  deviceConnected(&info);
}

void VirtualDriver::unplug() {
  OniDeviceInfo info;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    info = info_;
    plugged_ = false;
    for (const auto& device : devices_) device->unplug();
  }
  deviceDisconnected(&info);
}

void VirtualDriver::runPlugging() {
  for (const PlugEvent& event : context_->settings().plug_events) {
    {
      std::unique_lock<std::mutex> lock(mutex_);
      if (stop_.wait_until(lock, context_->afterLoad(event.time), [this] { return stopping_; })) return;
    }
    if (event.plugged) {
      plugIn();
    } else {
      unplug();
    }
  }
}

void VirtualDriver::stopPlugging() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  stop_.notify_all();
  if (plugging_.joinable()) plugging_.join();
}

}  // namespace rgbd_sfm_fusion
