// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/camera/camera_device.h"

#include <OpenNI.h>

#include <algorithm>
#include <utility>

#include "pixel_format.h"
#include "rgbd_sfm_fusion/camera/device_selection.h"

namespace rgbd_sfm_fusion {
namespace {

openni::SensorType toSensorType(StreamKind stream) {
  switch (stream) {
    case StreamKind::kColour:
      return openni::SENSOR_COLOR;
    case StreamKind::kDepth:
      return openni::SENSOR_DEPTH;
    default:
      return openni::SENSOR_IR;
  }
}

/// @throws CameraError with OpenNI2's own words unless `status` is good
void check(openni::Status status, const std::string& what) {
  if (status != openni::STATUS_OK) throw CameraError(what + ": " + OpenNiLibrary::lastError());
}

StreamMode toStreamMode(const openni::VideoMode& mode) {
  return {mode.getResolutionX(), mode.getResolutionY(), mode.getFps()};
}

}  // namespace

struct CameraDevice::Handles {
  openni::Device device;
  PerStream<openni::VideoStream> streams;
  openni::VideoFrameRef frame;
};

CameraDevice::CameraDevice(std::shared_ptr<OpenNiLibrary> library, const std::string& uri)
    : library_(std::move(library)), handles_(std::make_unique<Handles>()) {
  disconnections_ = library_->disconnections(uri);
  check(handles_->device.open(uri.c_str()), "cannot open " + uri + ", which another process may hold");
  description_.uri = uri;
  describe();
}

/// In the order that OpenNI2 needs: frame, synchronisation, streams, device.
CameraDevice::~CameraDevice() {
  handles_->frame.release();
  for (const StreamKind stream : kAllStreams) stop(stream);
  for (const StreamKind stream : kAllStreams) handles_->streams[stream].destroy();
  handles_->device.close();
}

void CameraDevice::describe() {
  openni::Device& device = handles_->device;
  const openni::DeviceInfo& info = device.getDeviceInfo();
  description_.name = std::string(info.getVendor()) + " " + info.getName();
  char serial[256] = {};
  int size = sizeof(serial) - 1;
  if (device.getProperty(openni::DEVICE_PROPERTY_SERIAL_NUMBER, serial, &size) == openni::STATUS_OK)
    description_.serial = serial;
  for (const StreamKind stream : kAllStreams) {
    const openni::SensorInfo* sensor = device.getSensorInfo(toSensorType(stream));
    if (sensor == nullptr) continue;
    const auto& modes = sensor->getSupportedVideoModes();
    std::vector<StreamMode>& known = description_.modes[stream];
    for (int i = 0; i < modes.getSize(); ++i) {
      const StreamMode mode = toStreamMode(modes[i]);
      const bool is_new = std::find(known.begin(), known.end(), mode) == known.end();
      if (is_new && canRead(stream, modes[i].getPixelFormat())) known.push_back(mode);
    }
  }
}

void CameraDevice::start(StreamKind kind, const StreamMode& mode) {
  const std::string what = std::string("cannot start ") + toText(kind) + " in " + toText(mode);
  openni::VideoStream& stream = handles_->streams[kind];
  if (!stream.isValid()) check(stream.create(handles_->device, toSensorType(kind)), what);

  openni::VideoMode video_mode;
  if (!findVideoMode(stream.getSensorInfo(), kind, mode, &video_mode))
    throw CameraError(what + ": the device has " + toText(description_.modes[kind]));
  if (synchronised_) enableFrameSync(false);
  check(stream.setVideoMode(video_mode), what);
  check(stream.start(), what);
  running_[kind] = true;
}

void CameraDevice::stop(StreamKind kind) {
  if (!running_[kind]) return;
  handles_->frame.release();
  if (synchronised_) enableFrameSync(false);
  handles_->streams[kind].stop();
  running_[kind] = false;
}

std::optional<CameraFrame> CameraDevice::read(std::chrono::milliseconds timeout) {
  handles_->frame.release();
  std::array<openni::VideoStream*, kAllStreams.size()> streams{};
  for (const StreamKind stream : kAllStreams) {
    if (running_[stream]) streams[static_cast<std::size_t>(stream)] = &handles_->streams[stream];
  }
  int ready = -1;
  const openni::Status status = openni::OpenNI::waitForAnyStream(
      streams.data(), static_cast<int>(streams.size()), &ready, static_cast<int>(timeout.count()));
  if (status != openni::STATUS_OK) return {};

  const StreamKind kind = kAllStreams[static_cast<std::size_t>(ready)];
  openni::VideoStream& stream = handles_->streams[kind];
  openni::VideoFrameRef& frame = handles_->frame;
  check(stream.readFrame(&frame), std::string("cannot read ") + toText(kind));

  CameraFrame result;
  result.stream = kind;
  result.image = viewPixels(frame, &converted_);
  result.device_time = frame.getTimestamp();
  result.index = frame.getFrameIndex();
  result.registered = kind == StreamKind::kDepth && registered_;
  const openni::VideoStream& colour = handles_->streams[StreamKind::kColour];
  const bool colour_pixels = result.registered && colour.isValid();
  result.horizontal_fov = static_cast<double>((colour_pixels ? colour : stream).getHorizontalFieldOfView());
  return result;
}

void CameraDevice::setRegistration(bool on) {
  const auto mode = on ? openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR : openni::IMAGE_REGISTRATION_OFF;
  openni::Device& device = handles_->device;
  registered_ = false;
  if (on && !device.isImageRegistrationModeSupported(mode))
    throw CameraError("the device does not register depth to colour");
  if (!device.isImageRegistrationModeSupported(mode)) return;
  check(device.setImageRegistrationMode(mode), "cannot switch registration");
  registered_ = on;
}

/// Call this only while both streams run: streams that start later are not included. Switching replaces
/// OpenNI2's frame holders, so nothing is done where nothing changes.
void CameraDevice::setFrameSync(bool on) {
  const bool both = running_[StreamKind::kColour] && running_[StreamKind::kDepth];
  if ((on && both) != synchronised_) enableFrameSync(on && both);
}

void CameraDevice::enableFrameSync(bool on) {
  synchronised_ = false;
  handles_->frame.release();
  const openni::Status status = handles_->device.setDepthColorSyncEnabled(on);
  if (on) check(status, "cannot synchronise colour and depth");
  synchronised_ = on;
}

void CameraDevice::setMirror(StreamKind kind, bool on) {
  openni::VideoStream& stream = handles_->streams[kind];
  if (!stream.isPropertySupported(openni::STREAM_PROPERTY_MIRRORING)) {
    if (on) throw CameraError(std::string("the device does not mirror ") + toText(kind));
    return;
  }
  check(stream.setMirroringEnabled(on), std::string("cannot switch mirroring of ") + toText(kind));
}

void CameraDevice::setExposure(const CameraSettings& settings) {
  openni::CameraSettings* camera = handles_->streams[StreamKind::kColour].getCameraSettings();
  if (camera == nullptr) {
    if (settings.auto_exposure && settings.auto_white_balance) return;
    throw CameraError("the device has no settings of exposure and white balance");
  }
  check(camera->setAutoWhiteBalanceEnabled(settings.auto_white_balance), "cannot switch white balance");
  check(camera->setAutoExposureEnabled(settings.auto_exposure), "cannot switch auto exposure");
  if (!settings.auto_exposure && settings.exposure > 0)
    check(camera->setExposure(settings.exposure),
          "cannot set exposure to " + std::to_string(settings.exposure));
}

std::unique_ptr<CameraDevice> openCamera(const std::shared_ptr<OpenNiLibrary>& library,
                                         const std::string& selector) {
  const std::vector<std::string> uris = library->uris();
  std::string reasons;
  for (const DeviceCandidate& candidate : selectDevices(selector, uris)) {
    try {
      auto device = std::make_unique<CameraDevice>(library, candidate.uri);
      if (!candidate.check_serial || device->description().serial == selector) return device;
    } catch (const CameraError& error) {
      reasons += std::string("\n  ") + error.what();
    }
  }
  throw CameraError(
      "no device " + (selector.empty() ? "" : "\"" + selector + "\" ") + "to open" + reasons +
      "\n  Devices seen: " + listUris(uris) + ". Drivers are looked for in " + OpenNiLibrary::driverFolder() +
      ". An Orbbec device (2bc5 in lsusb) that is not seen lacks its driver there, or a udev rule: "
      "see docs/astra.md");
}

}  // namespace rgbd_sfm_fusion
