// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rgbd_sfm_fusion/OpenNI2CameraConfig.h>

#include <functional>

#include "config_in_force.h"
#include "rgbd_sfm_fusion/camera/camera_types.h"

namespace rgbd_sfm_fusion {

/// The camera's settings that can be changed at run time. Modes that the device does not have or that are no
/// modes, and times that are no numbers, are refused with a message; the old values stay. If the new settings
/// cannot be put in force, all old ones stay.
class CameraSettingsInForce {
 public:
  struct Result {
    CameraSettings settings;
    double rgb_time_offset = 0.0;    ///< [s]
    double depth_time_offset = 0.0;  ///< [s]
  };

  /// @param device  of which the modes are known, if any is open
  /// @param apply   called after each change
  CameraSettingsInForce(std::function<DeviceDescription()> device, std::function<void(const Result&)> apply);
  CameraSettingsInForce(const CameraSettingsInForce&) = delete;
  CameraSettingsInForce& operator=(const CameraSettingsInForce&) = delete;

  ConfigInForce<OpenNI2CameraConfig>& config() { return config_; }

 private:
  void use(OpenNI2CameraConfig* config);
  StreamMode checkMode(StreamKind stream, const char* name, const std::string& last, std::string* text) const;

  std::function<DeviceDescription()> device_;
  std::function<void(const Result&)> apply_;
  ConfigInForce<OpenNI2CameraConfig> config_;
};

/// Lets dynamic reconfigure change these settings.
class CameraReconfiguration {
 public:
  using Result = CameraSettingsInForce::Result;

  /// @param mutex   held while the server calls
  /// @param device  of which the modes are known, if any is open
  /// @param apply   called at once, and after each change
  CameraReconfiguration(const ros::NodeHandle& private_handle, boost::recursive_mutex& mutex,
                        std::function<DeviceDescription()> device, std::function<void(const Result&)> apply);

 private:
  CameraSettingsInForce settings_;
  ReconfigureServer<OpenNI2CameraConfig> server_;
};

}  // namespace rgbd_sfm_fusion
