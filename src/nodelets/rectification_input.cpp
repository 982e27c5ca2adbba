// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rectification_input.h"

#include "rgbd_sfm_fusion/ros/calibration_file.h"
#include "rgbd_sfm_fusion/ros/conversions.h"

namespace rgbd_sfm_fusion {

bool RectificationInput::load(const std::string& url) {
  if (url.empty()) return false;
  use(readCalibrationFile(url));
  is_from_file_ = true;
  return true;
}

bool RectificationInput::update(const sensor_msgs::CameraInfo& info) {
  if (is_from_file_) return false;
  const CameraCalibration calibration = toCalibration(info);
  if (rectifier_ && calibration == calibration_) return false;
  use(calibration);
  return true;
}

void RectificationInput::updateDepth(const sensor_msgs::CameraInfo& info) {
  const CameraCalibration depth = toCalibration(info);
  if (depth_ && depth == *depth_) return;
  depth_ = depth;
  if (rectifier_) use(calibration_);
}

void RectificationInput::use(const CameraCalibration& calibration) {
  rectifier_ = std::make_shared<const Rectifier>(calibration, depth_, depth_is_rectified_);
  calibration_ = calibration;
}

}  // namespace rgbd_sfm_fusion
