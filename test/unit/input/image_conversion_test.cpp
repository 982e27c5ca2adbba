// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/image_conversion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace rgbd_sfm_fusion {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

TEST(ToDepthImage, MillimetresBecomeMetresAndZeroNone) {
  const cv::Mat_<std::uint16_t> raw = (cv::Mat_<std::uint16_t>(2, 3) << 0, 1, 999, 1000, 8000, 65535);
  const DepthImage depth = toDepthImage(raw, "16UC1");
  ASSERT_EQ(depth.size(), raw.size());
  EXPECT_TRUE(std::isnan(depth(0, 0)));
  for (int i = 1; i < 6; ++i) EXPECT_EQ(depth(i / 3, i % 3), static_cast<float>(raw(i / 3, i % 3) / 1000.0));
}

TEST(ToDepthImage, NeverLetsAnInvalidMetreThrough) {
  for (const float none : {kNaN, -kNaN, kInf, -kInf, 0.0f, -0.0f, -1e-30f, -5.0f})
    EXPECT_TRUE(std::isnan(toDepthImage(cv::Mat_<float>(3, 37, none), "32FC1")(2, 36))) << none;
  for (const float metres : {1e-30f, 0.4f, 5.0f, std::numeric_limits<float>::max()})
    EXPECT_EQ(toDepthImage(cv::Mat_<float>(3, 37, metres), "32FC1")(2, 36), metres);
}

TEST(ToDepthImage, BothEncodingsOfADepthGiveTheSameBits) {
  cv::Mat_<std::uint16_t> millimetres(256, 256);
  cv::Mat_<float> metres(256, 256);
  for (int i = 0; i < 65536; ++i) {
    millimetres(i / 256, i % 256) = static_cast<std::uint16_t>(i);
    metres(i / 256, i % 256) = i == 0 ? kNaN : static_cast<float>(i / 1000.0);
  }
  const DepthImage a = toDepthImage(millimetres, "16UC1"), b = toDepthImage(metres, "32FC1");
  EXPECT_EQ(std::memcmp(a.data, b.data, 65536 * sizeof(float)), 0);
}

TEST(ToDepthImage, ReadsRowsThatAreNotContiguous) {
  cv::Mat_<std::uint16_t> raw(4, 10, static_cast<std::uint16_t>(1000));
  raw.col(4) = 2000;
  const DepthImage depth = toDepthImage(raw(cv::Rect(4, 1, 3, 2)), "16UC1");
  EXPECT_EQ(depth(1, 0), 2.0f);
  EXPECT_EQ(depth(1, 1), 1.0f);
}

TEST(ToGreyImage, WeighsChannelsByTheirPlaceInTheEncoding) {
  const cv::Mat red_first(2, 2, CV_8UC3, cv::Scalar(255, 0, 0));
  EXPECT_NEAR(toGreyImage(red_first, "rgb8")(0, 0), 0.299 * 255, 1);
  EXPECT_NEAR(toGreyImage(red_first, "bgr8")(0, 0), 0.114 * 255, 1);
}

TEST(ToGreyImage, KeepsGreyAsItIs) {
  for (int value = 0; value < 256; ++value) {
    const cv::Mat image(2, 2, CV_8UC3, cv::Scalar::all(value));
    EXPECT_EQ(toGreyImage(image, "rgb8")(1, 1), value);
    EXPECT_EQ(toGreyImage(image, "bgr8")(1, 1), value);
  }
  const GreyImage mono(2, 2, std::uint8_t{7});
  EXPECT_EQ(toGreyImage(mono, "mono8").data, mono.data) << "without a copy";
}

template <class Convert>
std::string messageOf(Convert convert) {
  try {
    convert();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(ImageConversion, NamesTheBadEncodingAndTheGoodOnes) {
  const cv::Mat image(2, 2, CV_8UC3, cv::Scalar::all(0));
  for (const char* encoding : {"", "bayer_rggb8", "16UC1"}) {
    const std::string message = messageOf([&] { toGreyImage(image, encoding); });
    for (const char* part : {encoding, "rgb8", "bgr8", "mono8"})
      EXPECT_NE(message.find(part), std::string::npos) << message;
  }
  for (const char* encoding : {"", "rgb8", "64FC1"}) {
    const std::string message = messageOf([&] { toDepthImage(image, encoding); });
    for (const char* part : {encoding, "16UC1", "32FC1"})
      EXPECT_NE(message.find(part), std::string::npos) << message;
  }
}

TEST(ImageConversion, RefusesDataThatIsNotOfItsEncoding) {
  const cv::Mat image(2, 2, CV_8UC1, cv::Scalar::all(0));
  EXPECT_THROW(toGreyImage(image, "rgb8"), std::invalid_argument);
  EXPECT_THROW(toGreyImage(cv::Mat(2, 2, CV_8UC3), "mono8"), std::invalid_argument);
  EXPECT_THROW(toDepthImage(image, "16UC1"), std::invalid_argument);
  EXPECT_THROW(toDepthImage(image, "32FC1"), std::invalid_argument);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
