// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "camera_reconfiguration.h"

#include <ros/console.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace rgbd_sfm_fusion {
namespace {

/// Puts the last good time in the place of a bad one. The server sees to the range, but lets NaN pass.
double checkTime(const char* name, double last, double* seconds) {
  if (!std::isfinite(*seconds)) {
    ROS_ERROR_STREAM("refused: " << name << " = " << *seconds << ": expected a number of seconds; " << last
                                 << " stays");
    *seconds = last;
  }
  return *seconds;
}

}  // namespace

CameraSettingsInForce::CameraSettingsInForce(std::function<DeviceDescription()> device,
                                             std::function<void(const Result&)> apply)
    : device_(std::move(device)),
      apply_(std::move(apply)),
      config_(OpenNI2CameraConfig::__getDefault__(), [this](OpenNI2CameraConfig& config) { use(&config); }) {}

void CameraSettingsInForce::use(OpenNI2CameraConfig* config) {
  const OpenNI2CameraConfig& last = *config_;
  Result result;
  CameraSettings& settings = result.settings;
  settings.modes[StreamKind::kColour] =
      checkMode(StreamKind::kColour, "rgb_mode", last.rgb_mode, &config->rgb_mode);
  settings.modes[StreamKind::kDepth] =
      checkMode(StreamKind::kDepth, "depth_mode", last.depth_mode, &config->depth_mode);
  settings.modes[StreamKind::kInfrared] =
      checkMode(StreamKind::kInfrared, "ir_mode", last.ir_mode, &config->ir_mode);
  settings.registration = config->registration;
  settings.frame_sync = config->frame_sync;
  settings.mirror = config->mirror;
  settings.auto_exposure = config->auto_exposure;
  settings.exposure = config->exposure;
  settings.auto_white_balance = config->auto_white_balance;
  result.rgb_time_offset = checkTime("rgb_time_offset", last.rgb_time_offset, &config->rgb_time_offset);
  result.depth_time_offset =
      checkTime("depth_time_offset", last.depth_time_offset, &config->depth_time_offset);
  apply_(result);
}

/// Puts the last good mode in the place of a bad one.
StreamMode CameraSettingsInForce::checkMode(StreamKind stream, const char* name, const std::string& last,
                                            std::string* text) const {
  try {
    const StreamMode mode = parseStreamMode(*text);
    const std::vector<StreamMode> known = device_().modes[stream];
    if (known.empty() || std::find(known.begin(), known.end(), mode) != known.end()) return mode;
    throw std::invalid_argument(*text + ": the device has " + toText(known));
  } catch (const std::invalid_argument& error) {
    ROS_ERROR_STREAM("refused: " << name << " " << error.what() << "; " << last << " stays");
  }
  *text = last;
  return parseStreamMode(last);
}

CameraReconfiguration::CameraReconfiguration(const ros::NodeHandle& private_handle,
                                             boost::recursive_mutex& mutex,
                                             std::function<DeviceDescription()> device,
                                             std::function<void(const Result&)> apply)
    : settings_(std::move(device), std::move(apply)),
      server_(private_handle, mutex, &settings_.config(), true) {}

}  // namespace rgbd_sfm_fusion
