// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dynamic_reconfigure/server.h>
#include <rgbd_sfm_fusion/OpenNI2CameraConfig.h>

#include <boost/thread/recursive_mutex.hpp>
#include <functional>

#include "rgbd_sfm_fusion/camera/camera_types.h"

namespace rgbd_sfm_fusion {

/// Dynamic reconfigure of the camera. A mode that is no mode, or that the device does not have, is refused
/// with a message, and the old one stays.
class CameraReconfiguration {
 public:
  struct Result {
    CameraSettings settings;
    double rgb_time_offset = 0.0;    ///< [s]
    double depth_time_offset = 0.0;  ///< [s]
  };

  /// @param device  of which the modes are known, if any is open
  /// @param apply   called at once, and after each change
  CameraReconfiguration(const ros::NodeHandle& private_handle, std::function<DeviceDescription()> device,
                        std::function<void(const Result&)> apply);

 private:
  void change(OpenNI2CameraConfig* config);
  StreamMode checkMode(StreamKind stream, const char* name, const std::string& last, std::string* text) const;

  std::function<DeviceDescription()> device_;
  std::function<void(const Result&)> apply_;
  OpenNI2CameraConfig last_ = OpenNI2CameraConfig::__getDefault__();
  boost::recursive_mutex mutex_;
  dynamic_reconfigure::Server<OpenNI2CameraConfig> server_;
};

}  // namespace rgbd_sfm_fusion
