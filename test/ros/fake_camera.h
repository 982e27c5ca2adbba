// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/core.hpp>
#include <string>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/stamp.h"

namespace rgbd_sfm_fusion {

/// An RGB-D camera that slides along a textured, slanted wall. Its images are small enough to make thousands,
/// and their depth is known exactly. Frame n is taken at (n * kStep, 0, 0) in the axes of frame 0.
class FakeCamera {
 public:
  FakeCamera() = default;
  explicit FakeCamera(const PinholeCamera& camera) : camera_(camera) {}

  static constexpr double kStep = 0.01;         ///< [m] between two frames
  static constexpr Stamp kPeriod = 33'000'000;  ///< [ns]

  std::string frame_id = "camera_rgb_optical_frame";
  std::string colour_encoding = "rgb8";   ///< or bgr8, mono8
  std::string depth_encoding = "16UC1";   ///< or 32FC1
  Stamp first_stamp = 1'000'000'000'000;  ///< [ns]
  Stamp skew = 0;                         ///< [ns] depth is this much later than colour
  double contrast = 1.0;                  ///< 0: no texture at all
  float hole = 0.0F;                      ///< share of the image, at its right, without sensor depth

  const PinholeCamera& camera() const { return camera_; }
  Stamp stamp(int frame) const { return first_stamp + frame * kPeriod; }

  /// True depth of a pixel. The wall: Z = 2 + 0.3 X.
  float depth(int frame, int x) const {
    const double ray = (x - camera_.cx) / camera_.fx;
    return static_cast<float>((2.0 + 0.3 * kStep * frame) / (1.0 - 0.3 * ray));
  }

  std_msgs::Header header(Stamp stamp) const {
    std_msgs::Header header;
    header.stamp = toRosTime(stamp);
    header.frame_id = frame_id;
    return header;
  }

  sensor_msgs::CameraInfo info(int frame) const { return toCameraInfo(header(stamp(frame)), camera_); }

  sensor_msgs::ImagePtr colour(int frame) const {
    cv::Mat_<std::uint8_t> grey(camera_.height, camera_.width);
    for (int y = 0; y < grey.rows; ++y) {
      for (int x = 0; x < grey.cols; ++x) grey(y, x) = brightness(frame, x, y);
    }
    cv::Mat image = grey;
    if (colour_encoding != "mono8") {
      const cv::Mat channels[] = {grey, grey, grey};
      cv::merge(channels, 3, image);
    }
    return toImage(header(stamp(frame)), colour_encoding, image);
  }

  sensor_msgs::ImagePtr depthImage(int frame) const {
    cv::Mat_<float> metres(camera_.height, camera_.width);
    for (int y = 0; y < metres.rows; ++y) {
      for (int x = 0; x < metres.cols; ++x) {
        const bool seen = static_cast<float>(x) < (1.0F - hole) * static_cast<float>(metres.cols);
        metres(y, x) = seen ? std::round(1000.0F * depth(frame, x)) / 1000.0F : 0.0F;
      }
    }
    if (depth_encoding == "32FC1") {
      metres.setTo(std::numeric_limits<float>::quiet_NaN(), metres == 0.0F);
      return toImage(header(stamp(frame) + skew), depth_encoding, metres);
    }
    cv::Mat millimetres;
    metres.convertTo(millimetres, CV_16U, 1000.0);
    return toImage(header(stamp(frame) + skew), depth_encoding, millimetres);
  }

 private:
  std::uint8_t brightness(int frame, int x, int y) const {
    const double z = static_cast<double>(depth(frame, x));
    const double X = (x - camera_.cx) / camera_.fx * z + kStep * frame;
    const double Y = (y - camera_.cy) / camera_.fy * z;
    const double pattern = std::sin(19.0 * X) + std::sin(23.0 * Y + 4.0 * X) + std::sin(41.0 * X - 31.0 * Y) +
                           std::sin(7.0 * X + 11.0 * Y);
    return static_cast<std::uint8_t>(std::lround(128.0 + contrast * 27.0 * pattern));
  }

  PinholeCamera camera_{320, 240, 260.0, 260.0, 159.5, 119.5};
};

}  // namespace rgbd_sfm_fusion
