// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/rgbd_bag.h"

#include <sensor_msgs/image_encodings.h>

#include <string>

#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/stamp.h"

namespace rgbd_sfm_fusion {
namespace {

void write(BagOutput& bag, const std::string& topics, Stamp stamp, const std::string& encoding,
           const cv::Mat& image, sensor_msgs::CameraInfo& info) {
  info.header.stamp = toRosTime(stamp);
  info.header.frame_id = "camera_rgb_optical_frame";
  bag.write(topics + "/camera_info", info);
  bag.write(topics + "/image_raw", *toImage(info.header, encoding, image));
}

}  // namespace

void writeColour(BagOutput& bag, Stamp stamp, const cv::Mat& rgb, sensor_msgs::CameraInfo info) {
  write(bag, "/camera/rgb", stamp, sensor_msgs::image_encodings::RGB8, rgb, info);
}

void writeDepth(BagOutput& bag, Stamp stamp, const cv::Mat& depth, sensor_msgs::CameraInfo info) {
  write(bag, "/camera/depth_registered", stamp, sensor_msgs::image_encodings::TYPE_16UC1, depth, info);
}

}  // namespace rgbd_sfm_fusion
