// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/compressed_image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "rgbd_sfm_fusion/input/image_conversion.h"

namespace rgbd_sfm_fusion {
namespace {

using Bytes = std::vector<std::uint8_t>;

cv::Mat pattern(int type) {
  cv::Mat image(24, 32, type);
  cv::RNG random(1);
  random.fill(image, cv::RNG::UNIFORM, 0, CV_MAT_DEPTH(type) == CV_16U ? 65536 : 256);
  return image;
}

cv::Mat smoothDepth() {
  cv::Mat_<std::uint16_t> depth(24, 32);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x)
      depth(y, x) = static_cast<std::uint16_t>((x + y) % 7 == 0 ? 0 : 500 + 90 * x - 13 * y);
  }
  return depth;
}

Bytes encode(const std::string& extension, const cv::Mat& image) {
  Bytes bytes;
  cv::imencode(extension, image, bytes);
  return bytes;
}

void append(Bytes* bytes, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) bytes->push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

Bytes depthHeader(float A, float B) {
  Bytes bytes;
  append(&bytes, 0);
  for (const float value : {A, B}) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    append(&bytes, bits);
  }
  return bytes;
}

Bytes joined(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// RVL as in Wilson 2017, written for tests.
Bytes encodeRvl(const cv::Mat_<std::uint16_t>& image) {
  std::vector<std::uint32_t> nibbles;
  const auto write = [&](std::uint32_t value) {
    do {
      nibbles.push_back((value & 7U) | (value > 7U ? 8U : 0U));
      value >>= 3U;
    } while (value != 0);
  };
  const std::vector<std::uint16_t> pixels(image.begin(), image.end());
  int previous = 0;
  for (std::size_t at = 0; at < pixels.size();) {
    std::size_t zeros = 0, others = 0;
    while (at + zeros < pixels.size() && pixels[at + zeros] == 0) ++zeros;
    at += zeros;
    while (at + others < pixels.size() && pixels[at + others] != 0) ++others;
    write(static_cast<std::uint32_t>(zeros));
    write(static_cast<std::uint32_t>(others));
    for (std::size_t end = at + others; at < end; ++at) {
      const int delta = pixels[at] - previous;
      write(static_cast<std::uint32_t>(delta < 0 ? -2 * delta - 1 : 2 * delta));
      previous = pixels[at];
    }
  }
  Bytes bytes;
  append(&bytes, static_cast<std::uint32_t>(image.cols));
  append(&bytes, static_cast<std::uint32_t>(image.rows));
  while (nibbles.size() % 8 != 0) nibbles.push_back(0);
  for (std::size_t i = 0; i < nibbles.size(); i += 8) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 8; ++k) word = (word << 4U) | nibbles[i + k];
    append(&bytes, word);
  }
  return bytes;
}

DecodedImage decode(const std::string& format, const Bytes& bytes) {
  return decodeImage({format, bytes.data(), bytes.size()});
}

std::string refusalOf(const std::string& format, const Bytes& bytes) {
  try {
    decode(format, bytes);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

void expectSame(const cv::Mat& a, const cv::Mat& b) {
  ASSERT_EQ(a.type(), b.type());
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(cv::norm(a, b, cv::NORM_INF), 0.0);
}

TEST(CompressedImage, PngGivesTheSameBits) {
  const struct {
    int type;
    const char *format, *encoding;
  } cases[] = {
      {CV_8UC3, "rgb8; png compressed bgr8", "bgr8"},
      {CV_8UC3, "bgr8; png compressed bgr8", "bgr8"},
      {CV_8UC3, "png", "bgr8"},
      {CV_8UC3, "rgb8; png compressed", "rgb8"},  // as image_transport's plug-in takes it
      {CV_8UC1, "mono8; png compressed ", "mono8"},
      {CV_8UC1, "bayer_grbg8; png compressed ", "bayer_grbg8"},
      {CV_8UC3, "bayer_grbg8; png compressed bgr8", "bgr8"},
      {CV_8UC4, "bgra8; png compressed bgr8", "bgra8"},
      {CV_16UC1, "16UC1; png compressed ", "mono16"},
      {CV_16UC1, "mono16; png compressed ", "mono16"},
      {CV_16UC3, "rgb16; png compressed bgr16", "bgr16"},
  };
  for (const auto& each : cases) {
    SCOPED_TRACE(each.format);
    const cv::Mat image = pattern(each.type);
    const DecodedImage decoded = decode(each.format, encode(".png", image));
    EXPECT_EQ(decoded.encoding, each.encoding);
    expectSame(decoded.pixels, image);
  }
}

TEST(CompressedImage, JpegIsRead) {
  const cv::Mat image(24, 32, CV_8UC3, cv::Scalar(10, 100, 200));
  const DecodedImage colour = decode("rgb8; jpeg compressed bgr8", encode(".jpg", image));
  EXPECT_EQ(colour.encoding, "bgr8");
  ASSERT_EQ(colour.pixels.size(), image.size());
  EXPECT_LT(cv::norm(colour.pixels, image, cv::NORM_INF), 4.0);
  const DecodedImage grey =
      decode("mono8; jpeg compressed ", encode(".jpg", cv::Mat(24, 32, CV_8UC1, cv::Scalar(77))));
  EXPECT_EQ(grey.encoding, "mono8");
  Bytes padded = encode(".jpg", image);
  padded.resize(padded.size() + 100);  // some cameras do so
  expectSame(decode("jpeg", padded).pixels, colour.pixels);
}

TEST(CompressedImage, CompressedDepthOfMillimetresIsAsItWas) {
  const cv::Mat depth = smoothDepth();
  const Bytes png = joined(Bytes(12), encode(".png", depth));
  for (const char* format : {"16UC1; compressedDepth", "16UC1; compressedDepth png"}) {
    const DecodedImage decoded = decode(format, png);
    EXPECT_EQ(decoded.encoding, "16UC1");
    expectSame(decoded.pixels, depth);
  }
  const DecodedImage rvl = decode("16UC1; compressedDepth rvl", joined(Bytes(12), encodeRvl(depth)));
  EXPECT_EQ(rvl.encoding, "16UC1");
  expectSame(rvl.pixels, depth);
}

TEST(CompressedImage, RvlIsReadAsPublished) {
  // [0 5]: no depth once, depth once, 5 more than 0 (folded: 10 = 010 and more, 1).
  const Bytes bytes = {2, 0, 0, 0, 1, 0, 0, 0, 0x00, 0x00, 0xa1, 0x11};
  const cv::Mat image = decode("16UC1; compressedDepth rvl", joined(Bytes(12), bytes)).pixels;
  EXPECT_EQ(image.at<std::uint16_t>(0), 0);
  EXPECT_EQ(image.at<std::uint16_t>(1), 5);
  cv::Mat_<std::uint16_t> extreme(2, 3);
  extreme << 65535, 1, 65535, 0, 0, 1;
  expectSame(decode("16UC1; compressedDepth rvl", joined(Bytes(12), encodeRvl(extreme))).pixels, extreme);
}

TEST(CompressedImage, CompressedDepthOfMetresIsInverse) {
  const float A = 100.0F * 101.0F, B = 1.0F - A / 10.0F;  // as compressed_depth_image_transport has it
  cv::Mat_<std::uint16_t> quantised(1, 3);
  quantised << 0, static_cast<std::uint16_t>(std::lround(A / 2.0F + B)), 1;
  const Bytes png = encode(".png", quantised), rvl = encodeRvl(quantised);
  for (const auto& [format, data] :
       {std::pair("32FC1; compressedDepth png", png), {"32FC1; compressedDepth rvl", rvl}}) {
    const DecodedImage decoded = decode(format, joined(depthHeader(A, B), data));
    EXPECT_EQ(decoded.encoding, "32FC1");
    EXPECT_TRUE(std::isnan(decoded.pixels.at<float>(0)));
    EXPECT_NEAR(decoded.pixels.at<float>(1), 2.0F, 1e-3F);
    EXPECT_NEAR(decoded.pixels.at<float>(2), 10.0F, 1e-3F);
  }
  EXPECT_NE(refusalOf("32FC1; compressedDepth png", joined(depthHeader(NAN, 1), png)).find("A = nan"),
            std::string::npos);
  EXPECT_NE(refusalOf("32FC1; compressedDepth png", joined(Bytes(12), png)).find("A = 0"), std::string::npos);
}

TEST(CompressedImage, DepthAsJpegIsNoDepth) {
  const DecodedImage decoded = decode("mono8; jpeg compressed ", encode(".jpg", pattern(CV_8UC1)));
  EXPECT_THROW(toDepthImage(decoded.pixels, decoded.encoding), std::invalid_argument);
  const DecodedImage png = decode("16UC1; png compressed ", encode(".png", smoothDepth()));
  EXPECT_FLOAT_EQ(toDepthImage(png.pixels, png.encoding)(0, 1), 0.59F);
}

TEST(CompressedImage, WhatIsNeitherIsNamed) {
  EXPECT_NE(refusalOf("jpeg", {}).find("neither JPEG nor PNG"), std::string::npos);
  EXPECT_NE(refusalOf("jpeg", Bytes(100, 'x')).find("neither JPEG nor PNG"), std::string::npos);
  EXPECT_NE(refusalOf("tiff", encode(".tiff", pattern(CV_8UC1))).find("neither"), std::string::npos);
  EXPECT_NE(refusalOf("chess; compressedDepth", Bytes(100)).find("chess"), std::string::npos);
  EXPECT_NE(refusalOf("16UC1; compressedDepth", Bytes(12)).find("12 bytes"), std::string::npos);
  const Bytes colour = joined(Bytes(12), encode(".png", pattern(CV_8UC3)));
  EXPECT_NE(refusalOf("16UC1; compressedDepth", colour).find("16 bits"), std::string::npos);
}

TEST(CompressedImage, SizesAreCheckedBeforeAnythingIsDecoded) {
  Bytes png = encode(".png", pattern(CV_8UC1));
  png[18] = 0x40;  // of a width of 32 px: 16416
  EXPECT_NE(refusalOf("png", png).find("16416x24"), std::string::npos) << refusalOf("png", png);
  Bytes jpeg = encode(".jpg", pattern(CV_8UC1));
  const std::uint8_t frame[] = {0xff, 0xc0};
  const auto at = std::search(jpeg.begin(), jpeg.end(), frame, frame + 2);
  ASSERT_NE(at, jpeg.end());
  at[5] = 0x60;  // of a height of 24 px: 24600
  EXPECT_NE(refusalOf("jpeg", jpeg).find("32x24600"), std::string::npos) << refusalOf("jpeg", jpeg);
  Bytes rvl(12);
  append(&rvl, 8192), append(&rvl, 8192);
  EXPECT_NE(refusalOf("16UC1; compressedDepth rvl", rvl).find("8192x8192"), std::string::npos);
}

TEST(CompressedImage, WhatIsCutOffIsRefused) {
  const Bytes depth_header(12);
  const std::pair<std::string, Bytes> whole[] = {
      {"png", encode(".png", pattern(CV_8UC3))},
      {"jpeg", encode(".jpg", pattern(CV_8UC3))},
      {"16UC1; compressedDepth png", joined(depth_header, encode(".png", smoothDepth()))},
      {"16UC1; compressedDepth rvl", joined(depth_header, encodeRvl(smoothDepth()))},
  };
  for (const auto& [format, bytes] : whole) {
    EXPECT_EQ(refusalOf(format, bytes), "") << format;
    const bool is_png = format.find("png") != std::string::npos;
    // A PNG without its last chunks holds the whole image.
    const std::size_t rest = is_png ? 40 : 1;
    for (std::size_t size = 0; size + rest <= bytes.size(); size += 1 + size / 8)
      EXPECT_NE(refusalOf(format, {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)}), "")
          << format << ": " << size << " of " << bytes.size() << " bytes";
  }
}

TEST(CompressedImage, DamagedBytesGiveAnImageOrAReason) {
  std::mt19937 random(1);
  const std::pair<std::string, Bytes> whole[] = {
      {"png", encode(".png", pattern(CV_8UC3))},
      {"jpeg", encode(".jpg", pattern(CV_8UC3))},
      {"16UC1; compressedDepth rvl", joined(Bytes(12), encodeRvl(smoothDepth()))},
  };
  for (const auto& [format, bytes] : whole) {
    for (int i = 0; i < 200; ++i) {
      Bytes damaged = bytes;
      for (int k = 0; k < 3; ++k) damaged[random() % damaged.size()] = static_cast<std::uint8_t>(random());
      try {
        EXPECT_FALSE(decode(format, damaged).pixels.empty());
      } catch (const std::invalid_argument&) {
      }
    }
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
