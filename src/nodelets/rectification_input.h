// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <memory>
#include <optional>
#include <string>

#include "rgbd_sfm_fusion/input/rectification.h"

namespace rgbd_sfm_fusion {

/// Makes a Rectifier of each camera_info that differs from the one before, or of a calibration file.
class RectificationInput {
 public:
  /// What the images' topics are called tells whether they were rectified already: those that
  /// depth_image_proc has registered are called image_rect.
  void setTopics(const std::string& colour, const std::string& depth);

  /// Takes the file's calibration, whatever camera_info says from now on.
  /// @param url  as readCalibrationFile() takes it; empty: nothing is done
  /// @return whether there is a rectifier now
  /// @throws std::runtime_error naming the file and what is wrong with it
  bool load(const std::string& url);

  /// @return whether there is another rectifier now
  /// @throws std::invalid_argument naming the field that can't be used; then the one before stays: a broken
  ///         message between good ones changes nothing
  bool update(const sensor_msgs::CameraInfo& info);

  /// Of the depth images, which may be of another size than colour.
  /// @throws std::invalid_argument naming the field that can't be used
  void updateDepth(const sensor_msgs::CameraInfo& info);

  /// Null before the first usable camera_info.
  const std::shared_ptr<const Rectifier>& rectifier() const { return rectifier_; }
  const CameraCalibration& calibration() const { return calibration_; }
  /// Of depth; nothing before the first.
  const std::optional<CameraCalibration>& depthCalibration() const { return depth_; }
  /// How the camera that depth is registered to differs from the one that depth's camera_info tells of;
  /// nothing before both are known.
  std::optional<std::string> differenceOfDepth() const;
  bool colourIsRectified() const { return colour_is_rectified_; }

 private:
  void use(const CameraCalibration& calibration);

  std::shared_ptr<const Rectifier> rectifier_;
  CameraCalibration calibration_;
  std::optional<CameraCalibration> depth_;
  bool is_from_file_ = false;
  bool colour_is_rectified_ = false, depth_is_rectified_ = false;
};

}  // namespace rgbd_sfm_fusion
