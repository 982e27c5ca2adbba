// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <memory>
#include <string>

#include "rgbd_sfm_fusion/input/rectification.h"

namespace rgbd_sfm_fusion {

/// Makes a Rectifier of each camera_info that differs from the one before.
class RectificationInput {
 public:
  /// @return whether there is another rectifier now
  /// @throws std::invalid_argument naming the field that can't be used; then the one before stays: a broken
  ///         message between good ones changes nothing
  bool update(const sensor_msgs::CameraInfo& info);

  /// Null before the first usable camera_info.
  const std::shared_ptr<const Rectifier>& rectifier() const { return rectifier_; }
  const CameraCalibration& calibration() const { return calibration_; }

 private:
  std::shared_ptr<const Rectifier> rectifier_;
  CameraCalibration calibration_;
};

}  // namespace rgbd_sfm_fusion
