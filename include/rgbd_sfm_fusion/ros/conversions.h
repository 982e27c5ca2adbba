// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Converts parts of messages to the core's types, and back.
#pragma once

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Transform.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <opencv2/core.hpp>
#include <string>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/input/camera_calibration.h"
#include "rgbd_sfm_fusion/pipeline/frame_preparation.h"

namespace rgbd_sfm_fusion {

/// A frame's name without the leading '/' of old bags, which tf2 does not take.
std::string withoutSlash(std::string frame);

geometry_msgs::Transform toTransform(const SE3& T);
geometry_msgs::Pose toPose(const SE3& T);

/// Gives back what toTransform() was given, bit by bit.
/// @throws std::invalid_argument unless all is finite, and the quaternion not zero
SE3 fromTransform(const geometry_msgs::Transform& transform);

/// Calibration of the published image: the region of interest and the binning are applied.
/// @throws std::invalid_argument naming a field that no image can have
CameraCalibration toCalibration(const sensor_msgs::CameraInfo& info);

/// The camera_info of rectified images: D = 0, R = 1, P = K.
sensor_msgs::CameraInfo toCameraInfo(const std_msgs::Header& header, const PinholeCamera& camera);

/// Copies the pixels.
/// @param encoding  must be that of the type of `pixels`
void fillImage(const std_msgs::Header& header, const std::string& encoding, const cv::Mat& pixels,
               sensor_msgs::Image* image);
sensor_msgs::ImagePtr toImage(const std_msgs::Header& header, const std::string& encoding,
                              const cv::Mat& pixels);

/// @throws std::invalid_argument as decodeImage()
sensor_msgs::ImagePtr decompress(const sensor_msgs::CompressedImage& image);

/// The message's pixels, not copied (but for foreign byte order): valid as long as the message.
/// @throws std::invalid_argument as viewPixels()
cv::Mat viewImage(const sensor_msgs::ImageConstPtr& image);

/// The message as the pipeline takes it, its pixels not copied.
/// @param image  null: there is none
/// @throws std::invalid_argument as viewPixels()
RawImage toRawImage(const sensor_msgs::ImageConstPtr& image, Stamp stamp);

}  // namespace rgbd_sfm_fusion
