// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <opencv2/core.hpp>

#include "rgbd_sfm_fusion/ros/bag_output.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Writes an image and its camera_info on the topics, and in the frame, of a camera named `camera`.
/// @param rgb  CV_8UC3
/// @param info its header is replaced
void writeColour(BagOutput& bag, Stamp stamp, const cv::Mat& rgb, sensor_msgs::CameraInfo info);

/// The same of depth registered to colour.
/// @param depth CV_16UC1 [mm]
void writeDepth(BagOutput& bag, Stamp stamp, const cv::Mat& depth, sensor_msgs::CameraInfo info);

}  // namespace rgbd_sfm_fusion
