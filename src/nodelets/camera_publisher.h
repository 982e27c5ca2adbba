// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <camera_info_manager/camera_info_manager.h>
#include <image_transport/image_transport.h>

#include <functional>
#include <memory>
#include <string>

#include "rgbd_sfm_fusion/camera/camera_types.h"

namespace rgbd_sfm_fusion {

/// Calibration of one of the device's cameras: from a file, or else from the field of view that the driver
/// tells.
class CameraCalibrationSource {
 public:
  /// @param handle  where the service set_camera_info goes
  /// @param name    e.g. rgb; files are named by it and the device's serial number
  /// @param url     of camera_info_manager; empty for its default
  CameraCalibrationSource(const ros::NodeHandle& handle, const std::string& name, const std::string& url);

  void deviceChanged(const std::string& serial);

  /// Without header.
  sensor_msgs::CameraInfo info(const cv::Size& size, double horizontal_fov);

 private:
  std::string name_;
  std::string url_;
  std::string loaded_;  ///< name of the calibration
  camera_info_manager::CameraInfoManager manager_;
  bool has_warned_ = false;
};

/// One stream's image_raw and camera_info.
class CameraPublisher {
 public:
  /// @param changed  called when a subscriber comes or goes
  CameraPublisher(image_transport::ImageTransport* transport, const std::string& name,
                  const std::string& frame_id, const std::string& encoding,
                  CameraCalibrationSource* calibration, const std::function<void()>& changed);

  bool isWanted() const { return publisher_.getNumSubscribers() > 0; }

  /// @param offset  [s] added to the frame's stamp
  void publish(const CameraFrame& frame, double offset);

 private:
  std::string frame_id_;
  std::string encoding_;
  CameraCalibrationSource* calibration_;
  image_transport::CameraPublisher publisher_;
};

}  // namespace rgbd_sfm_fusion
