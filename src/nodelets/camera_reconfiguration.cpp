// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "camera_reconfiguration.h"

#include <ros/console.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace rgbd_sfm_fusion {

CameraReconfiguration::CameraReconfiguration(const ros::NodeHandle& private_handle,
                                             std::function<DeviceDescription()> device,
                                             std::function<void(const Result&)> apply)
    : device_(std::move(device)), apply_(std::move(apply)), server_(mutex_, private_handle) {
  server_.setCallback([this](OpenNI2CameraConfig& config, std::uint32_t) { change(&config); });
}

void CameraReconfiguration::change(OpenNI2CameraConfig* config) {
  Result result;
  CameraSettings& settings = result.settings;
  settings.modes[StreamKind::kColour] =
      checkMode(StreamKind::kColour, "rgb_mode", last_.rgb_mode, &config->rgb_mode);
  settings.modes[StreamKind::kDepth] =
      checkMode(StreamKind::kDepth, "depth_mode", last_.depth_mode, &config->depth_mode);
  settings.modes[StreamKind::kInfrared] =
      checkMode(StreamKind::kInfrared, "ir_mode", last_.ir_mode, &config->ir_mode);
  settings.registration = config->registration;
  settings.frame_sync = config->frame_sync;
  settings.mirror = config->mirror;
  settings.auto_exposure = config->auto_exposure;
  settings.exposure = config->exposure;
  settings.auto_white_balance = config->auto_white_balance;
  result.rgb_time_offset = config->rgb_time_offset;
  result.depth_time_offset = config->depth_time_offset;
  last_ = *config;
  apply_(result);
}

/// Puts the last good mode in the place of a bad one.
StreamMode CameraReconfiguration::checkMode(StreamKind stream, const char* name, const std::string& last,
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

}  // namespace rgbd_sfm_fusion
