// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rectification_input.h"

#include "rgbd_sfm_fusion/ros/conversions.h"

namespace rgbd_sfm_fusion {
namespace {

bool isSame(const CameraCalibration& a, const CameraCalibration& b) {
  return a.width == b.width && a.height == b.height && a.distortion_model == b.distortion_model &&
         a.D == b.D && a.K == b.K && a.R == b.R && a.P == b.P;
}

}  // namespace

bool RectificationInput::update(const sensor_msgs::CameraInfo& info) {
  const CameraCalibration calibration = toCalibration(info);
  if (rectifier_ && isSame(calibration, calibration_)) return false;
  rectifier_.reset();
  rectifier_ = std::make_shared<const Rectifier>(calibration);
  calibration_ = calibration;
  return true;
}

}  // namespace rgbd_sfm_fusion
