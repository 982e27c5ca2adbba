// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/conversions.h"

#include <gtest/gtest.h>
#include <sensor_msgs/image_encodings.h>
#include <boost/make_shared.hpp>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "rgbd_sfm_fusion/ros/stamp.h"

namespace rgbd_sfm_fusion {
namespace {

namespace encodings = sensor_msgs::image_encodings;

std_msgs::Header header() {
  std_msgs::Header header;
  header.stamp = ros::Time(1305031102, 175304001);
  header.frame_id = "camera_rgb_optical_frame";
  return header;
}

TEST(Stamp, SurvivesARoundTripToTheNanosecond) {
  for (const Stamp stamp :
       {Stamp{1}, Stamp{999'999'999}, Stamp{1305031102175304001}, Stamp{4294967295999999999}}) {
    EXPECT_EQ(fromRosTime(toRosTime(stamp)), stamp);
  }
}

TEST(Stamp, NoneIsZero) {
  EXPECT_TRUE(toRosTime(kNoStamp).isZero());
  EXPECT_EQ(fromRosTime(ros::Time()), kNoStamp);
}

TEST(Conversions, TransformsKeepEveryBit) {
  Vector6 xi;
  xi << 1.0 / 3.0, -1e-9, 1e6, 0.3, -0.2, 0.1;
  for (int i = 0; i < 50; ++i) {
    const SE3 T = SE3::exp(xi * i / 7.0) * SE3::exp(xi).inverse();
    const SE3 back = fromTransform(toTransform(T));
    EXPECT_EQ(back.rotation().coeffs(), T.rotation().coeffs());
    EXPECT_EQ(back.translation(), T.translation());
  }
}

TEST(Conversions, TransformsThatAreNoneAreRefused) {
  geometry_msgs::Transform zero;  // a message that nobody filled
  EXPECT_THROW(fromTransform(zero), std::invalid_argument);
  geometry_msgs::Transform transform = toTransform(SE3());
  transform.translation.y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(fromTransform(transform), std::invalid_argument);
  transform = toTransform(SE3());
  transform.rotation.x = std::numeric_limits<double>::infinity();
  EXPECT_THROW(fromTransform(transform), std::invalid_argument);
}

TEST(Conversions, CameraInfoGivesBackTheRectifiedCamera) {
  const PinholeCamera camera{640, 480, 517.306, 516.469, 318.643, 255.314};
  const sensor_msgs::CameraInfo info = toCameraInfo(header(), camera);
  EXPECT_EQ(info.header.stamp, header().stamp);
  EXPECT_EQ(info.header.frame_id, header().frame_id);
  for (const double d : info.D) EXPECT_EQ(d, 0.0);
  EXPECT_EQ(rectifiedCamera(toCalibration(info)), camera);
}

TEST(Conversions, CalibrationTakesEveryField) {
  sensor_msgs::CameraInfo info;
  info.width = 320;
  info.height = 240;
  info.distortion_model = "rational_polynomial";
  info.D = {1, 2, 3, 4, 5, 6, 7, 8};
  for (std::size_t i = 0; i < 9; ++i) info.K[i] = info.R[i] = static_cast<double>(i);
  for (std::size_t i = 0; i < 12; ++i) info.P[i] = static_cast<double>(i);
  const CameraCalibration calibration = toCalibration(info);
  EXPECT_EQ(calibration.width, 320);
  EXPECT_EQ(calibration.height, 240);
  EXPECT_EQ(calibration.distortion_model, "rational_polynomial");
  EXPECT_EQ(calibration.D, info.D);
  EXPECT_EQ(calibration.K[5], 5.0);
  EXPECT_EQ(calibration.R[8], 8.0);
  EXPECT_EQ(calibration.P[11], 11.0);
}

TEST(Conversions, ImagesKeepHeaderAndPixels) {
  const cv::Mat_<float> pixels = (cv::Mat_<float>(2, 3) << 1, 2, 3, 4, 5, NAN);
  const sensor_msgs::ImagePtr image = toImage(header(), encodings::TYPE_32FC1, pixels);
  EXPECT_EQ(image->header.stamp, header().stamp);
  EXPECT_EQ(image->width, 3U);
  EXPECT_EQ(image->height, 2U);
  EXPECT_EQ(image->step, 12U);
  const cv::Mat_<float> back = viewImage(image);
  EXPECT_EQ(back(1, 0), 4.0F);
  EXPECT_TRUE(std::isnan(back(1, 2)));
  EXPECT_EQ(back.data, image->data.data()) << "copied";
}

TEST(Conversions, RowsMayBePadded) {
  auto image = boost::make_shared<sensor_msgs::Image>();
  image->encoding = encodings::MONO8;
  image->width = 2;
  image->height = 2;
  image->step = 4;
  image->data = {1, 2, 99, 99, 3, 4, 99, 99};
  const cv::Mat_<std::uint8_t> pixels = viewImage(image);
  EXPECT_EQ(pixels(1, 0), 3);
  EXPECT_EQ(pixels(1, 1), 4);
}

TEST(Conversions, ContradictoryImagesAreRefused) {
  auto image = boost::make_shared<sensor_msgs::Image>();
  image->encoding = encodings::TYPE_16UC1;
  image->width = 4;
  image->height = 2;
  image->step = 8;
  image->data.resize(15);
  EXPECT_THROW(viewImage(image), std::invalid_argument) << "data too short";
  image->data.resize(16);
  EXPECT_NO_THROW(viewImage(image));
  image->step = 4;
  EXPECT_THROW(viewImage(image), std::invalid_argument) << "step too short";
  image->step = 8;
  image->encoding = "chequered";
  EXPECT_THROW(viewImage(image), std::invalid_argument) << "no such encoding";
}

}  // namespace
}  // namespace rgbd_sfm_fusion
