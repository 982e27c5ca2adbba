// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rectification_input.h"

#include "rgbd_sfm_fusion/ros/conversions.h"

namespace rgbd_sfm_fusion {

bool RectificationInput::update(const sensor_msgs::CameraInfo& info) {
  const CameraCalibration calibration = toCalibration(info);
  if (rectifier_ && calibration == calibration_) return false;
  rectifier_ = std::make_shared<const Rectifier>(calibration);
  calibration_ = calibration;
  return true;
}

}  // namespace rgbd_sfm_fusion
