// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/image_conversion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>
#include <utility>

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

TEST(ToDepthImage, CountsMayBeOfAnyUnit) {
  const cv::Mat_<std::uint16_t> raw(1, 1, static_cast<std::uint16_t>(10000));
  EXPECT_EQ(toDepthImage(raw, "16UC1", 0.0002)(0, 0), 2.0f);
  EXPECT_EQ(toDepthImage(raw, "mono16", 0.0001)(0, 0), 1.0f);
  EXPECT_EQ(toDepthImage(cv::Mat_<float>(1, 1, 3.0f), "32FC1", 0.0001)(0, 0), 3.0f) << "metres in any case";
}

TEST(DepthConversion, TheHighestCodeIsNoDepth) {
  const cv::Mat_<std::uint16_t> codes = (cv::Mat_<std::uint16_t>(1, 4) << 9999, 10000, 10001, 0);
  const cv::Mat_<float> metres = (cv::Mat_<float>(1, 4) << 9.999f, 10.0f, 10.001f, 0.0f);
  for (const DepthImage& depth :
       {toDepthImage(codes, "16UC1", kMillimetre, 10.0), toDepthImage(metres, "32FC1", kMillimetre, 10.0)}) {
    EXPECT_EQ(depth(0, 0), 9.999f);
    EXPECT_TRUE(std::isnan(depth(0, 1)));
    EXPECT_EQ(depth(0, 2), 10.001f);
  }
  EXPECT_EQ(toDepthImage(codes, "16UC1")(0, 1), 10.0f) << "without such a code";
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

/// A grey ramp in each of the encodings of colour.
TEST(ToGreyImage, TakesEveryEncodingOfColour) {
  cv::Mat_<cv::Vec3b> rgb(16, 16);
  for (int i = 0; i < 256; ++i) rgb(i / 16, i % 16) = cv::Vec3b::all(static_cast<std::uint8_t>(i));
  const GreyImage grey = toGreyImage(rgb, "rgb8");
  const auto inFourChannels = [&](int code) {
    cv::Mat image;
    cv::cvtColor(rgb, image, code);
    return image;
  };
  const auto inSixteenBits = [](const cv::Mat& image) {
    cv::Mat wide;
    image.convertTo(wide, CV_16U, 257.0);
    return wide;
  };
  for (const char* name : {"bgr8", "8UC3"}) EXPECT_EQ(cv::norm(toGreyImage(rgb, name), grey), 0.0) << name;
  for (const char* name : {"rgba8", "bgra8", "8UC4"})
    EXPECT_EQ(cv::norm(toGreyImage(inFourChannels(cv::COLOR_RGB2RGBA), name), grey), 0.0) << name;
  for (const char* name : {"rgb16", "bgr16"})
    EXPECT_EQ(cv::norm(toGreyImage(inSixteenBits(rgb), name), grey), 0.0) << name;
  for (const char* name : {"rgba16", "bgra16"})
    EXPECT_EQ(cv::norm(toGreyImage(inSixteenBits(inFourChannels(cv::COLOR_RGB2RGBA)), name), grey), 0.0);
  EXPECT_EQ(cv::norm(toGreyImage(inSixteenBits(grey), "mono16"), grey), 0.0);
  EXPECT_EQ(toGreyImage(grey, "8UC1").data, grey.data) << "without a copy";
}

TEST(ToGreyImage, TakesBrightnessOutOfYuv422) {
  for (const auto& [name, y_first] : {std::pair("yuv422", false), std::pair("yuv422_yuy2", true)}) {
    const int place = y_first ? 0 : 1;
    cv::Mat_<cv::Vec2b> yuv(4, 6, cv::Vec2b(128, 128));
    for (int x = 0; x < 6; ++x) yuv(2, x)[place] = static_cast<std::uint8_t>(20 * x);
    const GreyImage grey = toGreyImage(yuv, name);
    for (int x = 0; x < 6; ++x) EXPECT_EQ(grey(2, x), 20 * x) << name;
    EXPECT_THROW(toGreyImage(yuv.colRange(0, 5), name), std::invalid_argument) << "pixels come in pairs";
  }
}

TEST(ToGreyImage, KnowsWhichPixelsOfABayerPatternAreRed) {
  const struct {
    const char* name;
    int red_x, red_y;
  } patterns[] = {{"bayer_rggb", 0, 0}, {"bayer_grbg", 1, 0}, {"bayer_gbrg", 0, 1}, {"bayer_bggr", 1, 1}};
  constexpr double kGrey = 0.299 * 200 + 0.587 * 100 + 0.114 * 40;
  for (const auto& pattern : patterns) {
    cv::Mat_<std::uint8_t> raw(20, 20, std::uint8_t{100});  // green
    for (int y = 0; y < 20; ++y) {
      for (int x = 0; x < 20; ++x) {
        const bool red_column = x % 2 == pattern.red_x, red_row = y % 2 == pattern.red_y;
        if (red_column && red_row) raw(y, x) = 200;
        if (!red_column && !red_row) raw(y, x) = 40;  // blue
      }
    }
    cv::Mat wide;
    raw.convertTo(wide, CV_16U, 257.0);
    for (const auto& [image, bits] : {std::pair<cv::Mat, std::string>(raw, "8"), {wide, "16"}}) {
      const GreyImage grey = toGreyImage(image, pattern.name + bits);
      for (const cv::Point& place : {cv::Point(10, 10), {11, 10}, {10, 11}, {11, 11}})
        EXPECT_NEAR(grey(place), kGrey, 1.5) << pattern.name << bits << place;
    }
    EXPECT_THROW(toGreyImage(raw(cv::Rect(0, 0, 2, 2)), pattern.name + std::string("8")),
                 std::invalid_argument);
  }
}

TEST(ToDepthImage, Mono16IsMillimetresToo) {
  const cv::Mat_<std::uint16_t> raw = (cv::Mat_<std::uint16_t>(1, 2) << 0, 1500);
  EXPECT_EQ(toDepthImage(raw, "mono16")(0, 1), 1.5F);
  EXPECT_TRUE(std::isnan(toDepthImage(raw, "mono16")(0, 0)));
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
  for (const char* encoding : {"", "bayer_rggb", "16UC1"}) {
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
