// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "virtual_stream.h"

#include <algorithm>
#include <cmath>

#include "frame_source.h"
#include "properties.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kFarthest = 10000;  // [mm] as PrimeSense's own driver says

bool same(const OniVideoMode& a, const OniVideoMode& b) {
  return a.pixelFormat == b.pixelFormat && a.resolutionX == b.resolutionX && a.resolutionY == b.resolutionY &&
         a.fps == b.fps;
}

/// [rad] Over `pixels` pixels.
float fieldOfView(int pixels, double focal_length) {
  return static_cast<float>(2.0 * std::atan(0.5 * pixels / focal_length));
}

bool isPercentage(int value) {
  return value >= StreamProperties::kLeast && value <= StreamProperties::kMost;
}

}  // namespace

VirtualStream::VirtualStream(OniSensorType sensor, const PinholeCamera& camera, const SensorModes& modes,
                             FrameSource& source)
    : sensor_(sensor), camera_(camera), modes_(modes), source_(source) {
  properties_.mode = modes.of(sensor).front();
}

OniStatus VirtualStream::start() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    started_ = true;
  }
  const OniStatus status = source_.start(*this);
  if (status != ONI_STATUS_OK) {
    const std::lock_guard<std::mutex> lock(mutex_);
    started_ = false;
  }
  return status;
}

void VirtualStream::stop() {
  source_.stop(*this);
  const std::lock_guard<std::mutex> lock(mutex_);
  started_ = false;
}

StreamProperties VirtualStream::properties() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return properties_;
}

void VirtualStream::deliver(const cv::Mat& image, std::uint32_t index, std::uint64_t device_time) {
  const StreamProperties p = properties();
  OniFrame* frame = getServices().acquireFrame();
  if (frame == nullptr) return;
  const int stride = p.mode.resolutionX * pixelSize(p.mode.pixelFormat);
  frame->dataSize = stride * p.mode.resolutionY;
  frame->sensorType = sensor_;
  frame->timestamp = device_time;
  frame->frameIndex = static_cast<int>(index);
  frame->width = p.mode.resolutionX;
  frame->height = p.mode.resolutionY;
  frame->videoMode = p.mode;
  frame->croppingEnabled = FALSE;
  frame->cropOriginX = frame->cropOriginY = 0;
  frame->stride = stride;
  writeImage(image, p, frame->data);
  raiseNewFrame(frame);
  getServices().releaseFrame(frame);
}

OniBool VirtualStream::isPropertySupported(int property) {
  switch (property) {
    case ONI_STREAM_PROPERTY_VIDEO_MODE:
    case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
    case ONI_STREAM_PROPERTY_VERTICAL_FOV:
    case ONI_STREAM_PROPERTY_MIRRORING:
    case ONI_STREAM_PROPERTY_STRIDE:
      return TRUE;
    case ONI_STREAM_PROPERTY_MIN_VALUE:
    case ONI_STREAM_PROPERTY_MAX_VALUE:
      return sensor_ == ONI_SENSOR_DEPTH;
    case ONI_STREAM_PROPERTY_AUTO_EXPOSURE:
    case ONI_STREAM_PROPERTY_AUTO_WHITE_BALANCE:
    case ONI_STREAM_PROPERTY_EXPOSURE:
    case ONI_STREAM_PROPERTY_GAIN:
      return sensor_ == ONI_SENSOR_COLOR;
    default:
      return FALSE;
  }
}

OniStatus VirtualStream::getProperty(int property, void* data, int* size) {
  if (isPropertySupported(property) == FALSE) return ONI_STATUS_NOT_SUPPORTED;
  const StreamProperties p = properties();
  switch (property) {
    case ONI_STREAM_PROPERTY_VIDEO_MODE:
      return putProperty(p.mode, data, size);
    case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
      return putProperty(fieldOfView(camera_.width, camera_.fx), data, size);
    case ONI_STREAM_PROPERTY_VERTICAL_FOV:
      return putProperty(fieldOfView(camera_.height, camera_.fy), data, size);
    case ONI_STREAM_PROPERTY_MIRRORING:
      return putProperty(p.mirrored, data, size);
    case ONI_STREAM_PROPERTY_STRIDE:
      return putProperty(p.mode.resolutionX * pixelSize(p.mode.pixelFormat), data, size);
    case ONI_STREAM_PROPERTY_MIN_VALUE:
      return putProperty(0, data, size);
    case ONI_STREAM_PROPERTY_MAX_VALUE:
      return putProperty(kFarthest, data, size);
    case ONI_STREAM_PROPERTY_AUTO_EXPOSURE:
      return putProperty(p.auto_exposure, data, size);
    case ONI_STREAM_PROPERTY_AUTO_WHITE_BALANCE:
      return putProperty(p.auto_white_balance, data, size);
    case ONI_STREAM_PROPERTY_EXPOSURE:
      return putProperty(p.exposure, data, size);
    default:
      return putProperty(p.gain, data, size);
  }
}

OniStatus VirtualStream::setProperty(int property, const void* data, int size) {
  if (isPropertySupported(property) == FALSE) return ONI_STATUS_NOT_SUPPORTED;
  if (source_.unplugged()) return ONI_STATUS_NO_DEVICE;
  if (property == ONI_STREAM_PROPERTY_VIDEO_MODE) {
    OniVideoMode mode;
    const OniStatus status = takeProperty(data, size, mode);
    return status == ONI_STATUS_OK ? setMode(mode) : status;
  }
  int value = 0;  // all others are of type int or OniBool, which is int
  const OniStatus status = takeProperty(data, size, value);
  if (status != ONI_STATUS_OK) return status;
  const std::lock_guard<std::mutex> lock(mutex_);
  const OniBool on = value != 0 ? TRUE : FALSE;
  switch (property) {
    case ONI_STREAM_PROPERTY_MIRRORING:
      properties_.mirrored = on;
      break;
    case ONI_STREAM_PROPERTY_AUTO_EXPOSURE:
      properties_.auto_exposure = on;
      break;
    case ONI_STREAM_PROPERTY_AUTO_WHITE_BALANCE:
      properties_.auto_white_balance = on;
      break;
    case ONI_STREAM_PROPERTY_EXPOSURE:
    case ONI_STREAM_PROPERTY_GAIN: {
      if (!isPercentage(value)) return ONI_STATUS_BAD_PARAMETER;
      (property == ONI_STREAM_PROPERTY_GAIN ? properties_.gain : properties_.exposure) = value;
      break;
    }
    default:
      return ONI_STATUS_NOT_SUPPORTED;
  }
  return ONI_STATUS_OK;
}

OniStatus VirtualStream::setMode(const OniVideoMode& mode) {
  const std::vector<OniVideoMode>& known = modes_.of(sensor_);
  const bool is_known = std::any_of(known.begin(), known.end(), [&](const auto& m) { return same(m, mode); });
  if (!is_known) return ONI_STATUS_NOT_SUPPORTED;
  const std::lock_guard<std::mutex> lock(mutex_);
  if (started_)
    return ONI_STATUS_OUT_OF_FLOW;  // the frames that OpenNI2 has made room for are of the old mode
  properties_.mode = mode;
  return ONI_STATUS_OK;
}

}  // namespace rgbd_sfm_fusion
