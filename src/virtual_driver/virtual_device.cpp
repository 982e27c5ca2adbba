// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "virtual_device.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>

#include "properties.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr const char* kFirmware = "virtual 1.0";
constexpr OniVersion kDriverVersion = {1, 0, 0, 0};
constexpr int kHardwareVersion = 1;

}  // namespace

VirtualDevice::LockFile::~LockFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

bool VirtualDevice::LockFile::take(const std::string& path) {
  descriptor_ = open(path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666);
  return descriptor_ >= 0 && flock(descriptor_, LOCK_EX | LOCK_NB) == 0;
}

VirtualDevice::VirtualDevice(DriverContext& context, SteadyClock::time_point plugged_at)
    : context_(context),
      modes_(context.settings().camera.camera, context.settings().camera.rate),
      source_(context, plugged_at) {}

bool VirtualDevice::lock() {
  const std::string& path = context_.settings().lock;
  return path.empty() || lock_.take(path);
}

OniStatus VirtualDevice::getSensorInfoList(OniSensorInfo** infos, int* count) {
  *infos = modes_.infos().data();
  *count = static_cast<int>(modes_.infos().size());
  return ONI_STATUS_OK;
}

oni::driver::StreamBase* VirtualDevice::createStream(OniSensorType sensor) {
  if (source_.unplugged() || modes_.of(sensor).empty()) return nullptr;
  streams_.push_back(
      std::make_unique<VirtualStream>(sensor, context_.settings().camera.camera, modes_, source_));
  return streams_.back().get();
}

void VirtualDevice::destroyStream(oni::driver::StreamBase* stream) {
  const auto same = [stream](const auto& owned) { return owned.get() == stream; };
  streams_.erase(std::remove_if(streams_.begin(), streams_.end(), same), streams_.end());
}

OniBool VirtualDevice::isPropertySupported(int property) {
  switch (property) {
    case ONI_DEVICE_PROPERTY_FIRMWARE_VERSION:
    case ONI_DEVICE_PROPERTY_DRIVER_VERSION:
    case ONI_DEVICE_PROPERTY_HARDWARE_VERSION:
    case ONI_DEVICE_PROPERTY_SERIAL_NUMBER:
    case ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION:
      return TRUE;
    default:
      return FALSE;
  }
}

OniStatus VirtualDevice::getProperty(int property, void* data, int* size) {
  switch (property) {
    case ONI_DEVICE_PROPERTY_FIRMWARE_VERSION:
      return putProperty(std::string(kFirmware), data, size);
    case ONI_DEVICE_PROPERTY_DRIVER_VERSION:
      return putProperty(kDriverVersion, data, size);
    case ONI_DEVICE_PROPERTY_HARDWARE_VERSION:
      return putProperty(kHardwareVersion, data, size);
    case ONI_DEVICE_PROPERTY_SERIAL_NUMBER:
      return putProperty(context_.settings().serial, data, size);
    case ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION: {
      const OniImageRegistrationMode mode =
          source_.registered() ? ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR : ONI_IMAGE_REGISTRATION_OFF;
      return putProperty(mode, data, size);
    }
    default:
      return ONI_STATUS_NOT_SUPPORTED;
  }
}

OniStatus VirtualDevice::setProperty(int property, const void* data, int size) {
  if (property != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION) return ONI_STATUS_NOT_SUPPORTED;
  if (source_.unplugged()) return ONI_STATUS_NO_DEVICE;
  OniImageRegistrationMode mode = ONI_IMAGE_REGISTRATION_OFF;
  const OniStatus status = takeProperty(data, size, mode);
  if (status != ONI_STATUS_OK) return status;
  if (isImageRegistrationModeSupported(mode) == FALSE) return ONI_STATUS_BAD_PARAMETER;
  source_.setRegistered(mode == ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR);
  return ONI_STATUS_OK;
}

OniBool VirtualDevice::isImageRegistrationModeSupported(OniImageRegistrationMode mode) {
  return mode == ONI_IMAGE_REGISTRATION_OFF || mode == ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR;
}

}  // namespace rgbd_sfm_fusion
