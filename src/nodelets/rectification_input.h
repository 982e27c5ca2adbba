// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <memory>
#include <optional>
#include <string>

#include "rgbd_sfm_fusion/input/rectification.h"

namespace rgbd_sfm_fusion {

/// Makes a Rectifier from each camera_info that differs from the one before, or from a calibration file.
class RectificationInput {
 public:
  /// Tells it the names of the image topics, which say whether images are rectified already: depth_image_proc
  /// calls registered images image_rect.
  void setTopics(const std::string& colour, const std::string& depth);

  /// Takes the calibration from a file. From then on camera_info is ignored.
  /// @param url  as readCalibrationFile() takes it; empty: nothing is done
  /// @return whether there is a rectifier now
  /// @throws std::runtime_error naming the file and what is wrong with it
  bool load(const std::string& url);

  /// @return whether there is another rectifier now
  /// @throws std::invalid_argument naming the field that can't be used; then the one before stays: a broken
  ///         message between good ones changes nothing
  bool update(const sensor_msgs::CameraInfo& info);

  /// Takes the calibration of the depth images, which may have another size than colour.
  /// @throws std::invalid_argument naming the field that can't be used
  void updateDepth(const sensor_msgs::CameraInfo& info);

  /// Null before the first usable camera_info.
  const std::shared_ptr<const Rectifier>& rectifier() const { return rectifier_; }
  const CameraCalibration& calibration() const { return calibration_; }
  /// Of depth; nothing before the first.
  const std::optional<CameraCalibration>& depthCalibration() const { return depth_; }
  /// How the camera that depth is registered to differs from the camera that the depth camera_info describes;
  /// nothing until both are known.
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
