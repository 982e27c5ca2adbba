// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/image_view.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace rgbd_sfm_fusion {
namespace {

constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();

ImageBytes describe(const std::vector<std::uint8_t>& data, std::uint32_t width, std::uint32_t height,
                    std::uint32_t step, const std::string& encoding) {
  return {width, height, step, encoding, false, data.data(), data.size()};
}

std::string refusalOf(const ImageBytes& bytes) {
  try {
    viewPixels(bytes);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(ViewPixels, ShowsTheBytesThatAreThere) {
  std::vector<std::uint8_t> data(3 * 10);
  for (std::size_t i = 0; i < data.size(); ++i) data[i] = static_cast<std::uint8_t>(i);
  const cv::Mat view = viewPixels(describe(data, 4, 3, 10, "16UC1"));  // two bytes beyond each row
  EXPECT_EQ(view.type(), CV_16UC1);
  EXPECT_EQ(view.size(), cv::Size(4, 3));
  EXPECT_EQ(view.data, data.data());
  EXPECT_EQ(view.at<std::uint16_t>(2, 3), 26 + 256 * 27);
}

TEST(ViewPixels, TheLastRowMayEndWithItsPixels) {
  const std::vector<std::uint8_t> data(2 * 10 + 8);
  EXPECT_NO_THROW(viewPixels(describe(data, 4, 3, 10, "16UC1")));
  EXPECT_NE(refusalOf(describe(data, 4, 4, 10, "16UC1")), "");
}

TEST(ViewPixels, SwapsBytesOfTheOtherOrder) {
  const std::vector<std::uint8_t> data{0x01, 0x02, 0x03, 0x04};
  ImageBytes bytes = describe(data, 2, 1, 4, "16UC1");
  bytes.is_big_endian = true;
  EXPECT_EQ(viewPixels(bytes).at<std::uint16_t>(0, 0), 0x0102);
  EXPECT_EQ(viewPixels(bytes).at<std::uint16_t>(0, 1), 0x0304);
  const std::vector<std::uint8_t> one{0x3f, 0x80, 0x00, 0x00};
  bytes = describe(one, 1, 1, 4, "32FC1");
  bytes.is_big_endian = true;
  EXPECT_EQ(viewPixels(bytes).at<float>(0, 0), 1.0F);
  bytes = describe(data, 4, 1, 4, "mono8");
  bytes.is_big_endian = true;
  EXPECT_EQ(viewPixels(bytes).data, data.data()) << "a byte has no order";
}

/// Sizes around those at which products of 16, 31 and 32 bits wrap.
TEST(ViewPixels, BelievesNoSizeThatTheDataDoesNotHave) {
  const std::vector<std::uint8_t> data(4096);
  for (const char* encoding : {"mono8", "rgb8", "rgba16", "16UC1", "32FC1"}) {
    for (const std::uint32_t width : {0U, 1U, 16U, 65535U, 65536U, 65537U, 1U << 31U, kMost}) {
      for (const std::uint32_t height : {0U, 1U, 16U, 65535U, 65536U, 65537U, 1U << 31U, kMost}) {
        for (const std::uint32_t step : {0U, 1U, 15U, 65536U, 1U << 31U, kMost}) {
          const ImageBytes bytes = describe(data, width, height, step, encoding);
          const std::string refusal = refusalOf(bytes);
          if (refusal.empty()) {
            const cv::Mat view = viewPixels(bytes);
            ASSERT_LE(view.ptr(view.rows - 1) + static_cast<std::size_t>(view.cols) * view.elemSize(),
                      data.data() + data.size());
          } else {
            EXPECT_NE(refusal.find("expected"), std::string::npos) << refusal;
          }
        }
      }
    }
  }
  EXPECT_NE(refusalOf(describe(data, 16, 65537, 65536, "mono8")).find("16x65537"), std::string::npos);
  EXPECT_NE(refusalOf(describe(data, 64, 64, 65, "16UC1")).find("step is 65 bytes"), std::string::npos);
  EXPECT_NE(refusalOf(describe(data, 30, 60, 61, "16UC1")).find("multiple of 2"), std::string::npos);
  EXPECT_NE(refusalOf(describe(data, 64, 65, 64, "mono8")).find("data is 4096 bytes"), std::string::npos);
  EXPECT_EQ(refusalOf(describe(data, 64, 64, 64, "mono8")), "");
}

TEST(ViewPixels, NamesTheEncodingThatItDoesNotKnow) {
  const std::vector<std::uint8_t> data(4096);
  for (const std::string encoding : {"", "8UC0", "8UC5", "64FC1", "jpeg", "no such thing"}) {
    const std::string refusal = refusalOf(describe(data, 8, 8, 64, encoding));
    EXPECT_NE(refusal.find("\"" + encoding + "\""), std::string::npos) << refusal;
    EXPECT_NE(refusal.find("rgb8"), std::string::npos) << refusal;
  }
  EXPECT_LT(refusalOf(describe(data, 8, 8, 64, std::string(100000, 'x'))).size(), 1000U);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
