// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/image_view.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>

namespace rgbd_sfm_fusion {
namespace {

struct Encoding {
  const char* name;
  int type;
};

constexpr Encoding kEncodings[] = {
    {"mono8", CV_8UC1},         {"mono16", CV_16UC1},       {"rgb8", CV_8UC3},
    {"bgr8", CV_8UC3},          {"rgba8", CV_8UC4},         {"bgra8", CV_8UC4},
    {"rgb16", CV_16UC3},        {"bgr16", CV_16UC3},        {"rgba16", CV_16UC4},
    {"bgra16", CV_16UC4},       {"bayer_rggb8", CV_8UC1},   {"bayer_bggr8", CV_8UC1},
    {"bayer_gbrg8", CV_8UC1},   {"bayer_grbg8", CV_8UC1},   {"bayer_rggb16", CV_16UC1},
    {"bayer_bggr16", CV_16UC1}, {"bayer_gbrg16", CV_16UC1}, {"bayer_grbg16", CV_16UC1},
    {"yuv422", CV_8UC2},        {"yuv422_yuy2", CV_8UC2},   {"8UC1", CV_8UC1},
    {"8UC3", CV_8UC3},          {"8UC4", CV_8UC4},          {"16UC1", CV_16UC1},
    {"32FC1", CV_32FC1},
};

int typeOf(const std::string& encoding) {
  const auto* found = std::find_if(std::begin(kEncodings), std::end(kEncodings),
                                   [&](const Encoding& known) { return encoding == known.name; });
  if (found != std::end(kEncodings)) return found->type;
  std::string known;
  for (const Encoding& each : kEncodings) known += (known.empty() ? "" : ", ") + std::string(each.name);
  // The encoding of a broken message may be any text of any length.
  const std::string shown = encoding.size() <= 40 ? encoding : encoding.substr(0, 40) + "…";
  throw std::invalid_argument("encoding \"" + shown + "\" is not known, expected one of " + known);
}

[[noreturn]] void refuse(const ImageBytes& bytes, const std::string& field, std::int64_t value,
                         std::int64_t least) {
  throw std::invalid_argument(field + " is " + std::to_string(value) + " bytes, expected at least " +
                              std::to_string(least) + " for " + std::to_string(bytes.width) + "x" +
                              std::to_string(bytes.height) + " pixels of " + bytes.encoding);
}

bool isBigEndianMachine() {
  const std::uint16_t one = 1;
  return *reinterpret_cast<const std::uint8_t*>(&one) == 0;
}

cv::Mat withBytesSwapped(const cv::Mat& pixels) {
  cv::Mat swapped = pixels.clone();
  const std::size_t size = pixels.elemSize1();
  for (int y = 0; y < swapped.rows; ++y) {
    std::uint8_t* row = swapped.ptr(y);
    const std::size_t length = static_cast<std::size_t>(swapped.cols) * swapped.elemSize();
    for (std::size_t i = 0; i < length; i += size) std::reverse(row + i, row + i + size);
  }
  return swapped;
}

}  // namespace

void requireUsableSize(const char* what, std::int64_t width, std::int64_t height) {
  const bool is_usable = width > 0 && height > 0 && width <= kLongestSide && height <= kLongestSide &&
                         width * height <= kMostPixels;
  if (is_usable) return;
  throw std::invalid_argument(std::string(what) + ": width x height is " + std::to_string(width) + "x" +
                              std::to_string(height) + ", expected 1 to " + std::to_string(kLongestSide) +
                              " px each, and at most " + std::to_string(kMostPixels) + " px in all");
}

cv::Mat viewPixels(const ImageBytes& bytes) {
  const int type = typeOf(bytes.encoding);
  requireUsableSize("image", bytes.width, bytes.height);
  const auto row = static_cast<std::int64_t>(bytes.width) * static_cast<std::int64_t>(CV_ELEM_SIZE(type));
  const auto step = static_cast<std::int64_t>(bytes.step);
  if (step < row) refuse(bytes, "step", step, row);
  const auto value_size = static_cast<std::int64_t>(CV_ELEM_SIZE1(type));
  if (step % value_size != 0)
    throw std::invalid_argument("step is " + std::to_string(step) + " bytes, expected a multiple of " +
                                std::to_string(value_size) + " for " + bytes.encoding);
  // The last row may lack the padding after its pixels.
  const std::int64_t least = step * (static_cast<std::int64_t>(bytes.height) - 1) + row;
  if (static_cast<std::uint64_t>(bytes.size) < static_cast<std::uint64_t>(least))
    refuse(bytes, "data", static_cast<std::int64_t>(bytes.size), least);
  // OpenCV has no view of constant data.
  auto* data = const_cast<std::uint8_t*>(bytes.data);
  const cv::Mat pixels(static_cast<int>(bytes.height), static_cast<int>(bytes.width), type, data,
                       bytes.height == 1 ? static_cast<std::size_t>(row) : static_cast<std::size_t>(step));
  const bool is_foreign = CV_ELEM_SIZE1(type) > 1 && bytes.is_big_endian != isBigEndianMachine();
  return is_foreign ? withBytesSwapped(pixels) : pixels;
}

}  // namespace rgbd_sfm_fusion
