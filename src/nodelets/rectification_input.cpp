// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rectification_input.h"

#include "rgbd_sfm_fusion/input/topic_choice.h"
#include "rgbd_sfm_fusion/ros/calibration_file.h"
#include "rgbd_sfm_fusion/ros/conversions.h"
#include "shared_preparation.h"

namespace rgbd_sfm_fusion {

void RectificationInput::setTopics(const std::string& colour, const std::string& depth) {
  colour_is_rectified_ = isRectifiedByName(colour);
  depth_is_rectified_ = isRectifiedByName(depth);
}

bool RectificationInput::load(const std::string& url) {
  if (url.empty()) return false;
  const CameraCalibration calibration = readCalibrationFile(url);
  use(colour_is_rectified_ ? ofRectifiedImages(calibration) : calibration);
  is_from_file_ = true;
  return true;
}

bool RectificationInput::update(const sensor_msgs::CameraInfo& info) {
  if (is_from_file_) return false;
  CameraCalibration calibration = toCalibration(info);
  if (colour_is_rectified_) calibration = ofRectifiedImages(calibration);
  if (rectifier_ && calibration == calibration_) return false;
  use(calibration);
  return true;
}

void RectificationInput::updateDepth(const sensor_msgs::CameraInfo& info) {
  CameraCalibration depth = toCalibration(info);
  if (depth_is_rectified_) depth = ofRectifiedImages(depth);
  if (depth_ && depth == *depth_) return;
  depth_ = depth;
  if (rectifier_) use(calibration_);
}

std::optional<std::string> RectificationInput::differenceOfDepth() const {
  if (!rectifier_ || !depth_) return std::nullopt;
  return differenceOfDepthCamera(depth_is_rectified_ ? ofRectifiedImages(calibration_) : calibration_,
                                 *depth_);
}

void RectificationInput::use(const CameraCalibration& calibration) {
  rectifier_ = sharedRectifier(calibration, depth_, depth_is_rectified_);
  calibration_ = calibration;
}

}  // namespace rgbd_sfm_fusion
