// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/picture.h"

#include <gtest/gtest.h>
#include <boost/make_shared.hpp>

#include <stdexcept>

#include "nodelets/colour_input.h"

namespace rgbd_sfm_fusion {
namespace {

cv::Mat pictureOf(const std::string& encoding, const cv::Mat& pixels) {
  return toPicture({0, encoding, pixels});
}

TEST(Picture, ColoursBecomeRgb) {
  const cv::Vec3b rgb(10, 20, 30);
  const auto expectRgb = [&](const std::string& encoding, const cv::Mat& pixels) {
    const cv::Mat picture = pictureOf(encoding, pixels);
    ASSERT_EQ(picture.type(), CV_8UC3) << encoding;
    EXPECT_EQ(picture.at<cv::Vec3b>(1, 1), rgb) << encoding;
  };
  expectRgb("rgb8", cv::Mat(2, 2, CV_8UC3, cv::Scalar(10, 20, 30)));
  expectRgb("bgr8", cv::Mat(2, 2, CV_8UC3, cv::Scalar(30, 20, 10)));
  expectRgb("8UC3", cv::Mat(2, 2, CV_8UC3, cv::Scalar(30, 20, 10)));
  expectRgb("rgba8", cv::Mat(2, 2, CV_8UC4, cv::Scalar(10, 20, 30, 255)));
  expectRgb("bgra8", cv::Mat(2, 2, CV_8UC4, cv::Scalar(30, 20, 10, 255)));
}

TEST(Picture, OthersBecomeGrey) {
  for (const char* encoding : {"mono8", "8UC1"}) {
    const cv::Mat picture = pictureOf(encoding, cv::Mat(2, 2, CV_8UC1, cv::Scalar(77)));
    ASSERT_EQ(picture.type(), CV_8UC1) << encoding;
    EXPECT_EQ(picture.at<std::uint8_t>(1, 1), 77) << encoding;
  }
  const cv::Mat picture = pictureOf("mono16", cv::Mat(2, 2, CV_16UC1, cv::Scalar(256 * 77)));
  ASSERT_EQ(picture.type(), CV_8UC1);
  EXPECT_NEAR(picture.at<std::uint8_t>(1, 1), 77, 1);
}

TEST(Picture, BayerIsInColour) {
  EXPECT_EQ(pictureOf("bayer_rggb8", cv::Mat(8, 8, CV_8UC1, cv::Scalar(9))).type(), CV_8UC3);
}

TEST(Picture, SaysWhichEncodingCannotBeShown) {
  try {
    pictureOf("32FC2", cv::Mat(2, 2, CV_32FC2));
    ADD_FAILURE();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("32FC2"), std::string::npos) << error.what();
  }
}

sensor_msgs::ImageConstPtr imageAt(double stamp) {
  auto image = boost::make_shared<sensor_msgs::Image>();
  image->header.stamp = ros::Time(stamp);
  return image;
}

TEST(ColourBuffer, KnowsWhatIsThereAndWhatMayStillCome) {
  ColourBuffer buffer;
  EXPECT_TRUE(buffer.mayCome(ros::Time(1.0))) << "the first one is on its way";
  buffer.push(imageAt(1.0));
  buffer.push(imageAt(3.0));
  EXPECT_TRUE(buffer.find(ros::Time(1.0)));
  EXPECT_FALSE(buffer.find(ros::Time(2.0)));
  EXPECT_FALSE(buffer.mayCome(ros::Time(2.0))) << "it was lost";
  EXPECT_TRUE(buffer.mayCome(ros::Time(4.0)));
}

TEST(ColourBuffer, ForgetsWhatIsOlderAndNothingElse) {
  ColourBuffer buffer;
  for (const double stamp : {1.0, 2.0, 3.0}) buffer.push(imageAt(stamp));
  buffer.forgetOlderThan(ros::Time(2.0));
  EXPECT_FALSE(buffer.find(ros::Time(1.0)));
  EXPECT_TRUE(buffer.find(ros::Time(2.0)));
  EXPECT_TRUE(buffer.find(ros::Time(3.0)));
}

TEST(ColourBuffer, KeepsTwoSecondsOfAFastCamera) {
  ColourBuffer buffer;
  for (int i = 0; i < 1000; ++i) buffer.push(imageAt(1.0 + i / 60.0));
  EXPECT_TRUE(buffer.find(ros::Time(1.0 + 999 / 60.0)));
  EXPECT_TRUE(buffer.find(ros::Time(1.0 + 881 / 60.0)));
  EXPECT_FALSE(buffer.find(ros::Time(1.0 + 870 / 60.0)));
}

TEST(ColourBuffer, GoesOnWhereStampsJumpBack) {
  ColourBuffer buffer;
  buffer.push(imageAt(9.0));
  buffer.push(imageAt(1.0));
  EXPECT_TRUE(buffer.find(ros::Time(9.0)));
  EXPECT_TRUE(buffer.find(ros::Time(1.0)));
  EXPECT_TRUE(buffer.mayCome(ros::Time(1.1)));
}

}  // namespace
}  // namespace rgbd_sfm_fusion
