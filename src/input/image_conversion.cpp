// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/image_conversion.h"

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

namespace rgbd_sfm_fusion {
namespace {

void requireType(const cv::Mat& raw, int type, const std::string& encoding) {
  if (raw.type() != type)
    throw std::invalid_argument("image does not hold " + encoding + ", which its encoding names");
}

/// A division, not a product with 0.001: then 16UC1 and 32FC1 of the same depth give the same bits.
float metres(std::uint16_t count, float counts_per_metre) {
  return static_cast<float>(count) / counts_per_metre;
}

float metres(float depth, float /*counts_per_metre*/) {
  return depth;
}

/// Values that are no depth become NaN. A depth within half a millimetre of `saturated` counts as saturated.
float orNone(float depth, float saturated) {
  constexpr float kHalfCount = 0.5e-3f;
  const bool measured = depth > 0.0f && depth <= std::numeric_limits<float>::max() &&
                        !(std::abs(depth - saturated) < kHalfCount);
  return measured ? depth : kNoDepth;
}

template <class Raw>
DepthImage convertDepth(const cv::Mat& raw, double unit, float saturated) {
  const auto counts_per_metre = static_cast<float>(1.0 / unit);
  DepthImage depth(raw.size());
  for (int y = 0; y < raw.rows; ++y) {
    const Raw* in = raw.ptr<Raw>(y);
    float* out = depth[y];
    for (int x = 0; x < raw.cols; ++x) out[x] = orNone(metres(in[x], counts_per_metre), saturated);
  }
  return depth;
}

/// A colour encoding, and how OpenCV makes grey of it.
struct ColourEncoding {
  const char* name;
  int type;
  int to_grey;  ///< cv::ColorConversionCodes; kIsGrey where there is nothing to convert
};

constexpr int kIsGrey = -1;

// OpenCV names a Bayer pattern by its second row and column, ROS by its first.
constexpr ColourEncoding kColourEncodings[] = {
    {"rgb8", CV_8UC3, cv::COLOR_RGB2GRAY},
    {"bgr8", CV_8UC3, cv::COLOR_BGR2GRAY},
    {"mono8", CV_8UC1, kIsGrey},
    {"rgba8", CV_8UC4, cv::COLOR_RGBA2GRAY},
    {"bgra8", CV_8UC4, cv::COLOR_BGRA2GRAY},
    {"mono16", CV_16UC1, kIsGrey},
    {"rgb16", CV_16UC3, cv::COLOR_RGB2GRAY},
    {"bgr16", CV_16UC3, cv::COLOR_BGR2GRAY},
    {"rgba16", CV_16UC4, cv::COLOR_RGBA2GRAY},
    {"bgra16", CV_16UC4, cv::COLOR_BGRA2GRAY},
    {"bayer_rggb8", CV_8UC1, cv::COLOR_BayerBG2GRAY},
    {"bayer_bggr8", CV_8UC1, cv::COLOR_BayerRG2GRAY},
    {"bayer_gbrg8", CV_8UC1, cv::COLOR_BayerGR2GRAY},
    {"bayer_grbg8", CV_8UC1, cv::COLOR_BayerGB2GRAY},
    {"bayer_rggb16", CV_16UC1, cv::COLOR_BayerBG2GRAY},
    {"bayer_bggr16", CV_16UC1, cv::COLOR_BayerRG2GRAY},
    {"bayer_gbrg16", CV_16UC1, cv::COLOR_BayerGR2GRAY},
    {"bayer_grbg16", CV_16UC1, cv::COLOR_BayerGB2GRAY},
    {"yuv422", CV_8UC2, cv::COLOR_YUV2GRAY_UYVY},
    {"yuv422_yuy2", CV_8UC2, cv::COLOR_YUV2GRAY_YUY2},
    {"8UC1", CV_8UC1, kIsGrey},
    {"8UC3", CV_8UC3, cv::COLOR_BGR2GRAY},  // by OpenCV's own convention
    {"8UC4", CV_8UC4, cv::COLOR_BGRA2GRAY},
};

const ColourEncoding& findColourEncoding(const std::string& encoding) {
  std::string known;
  for (const ColourEncoding& each : kColourEncodings) {
    if (encoding == each.name) return each;
    known += (known.empty() ? "" : ", ") + std::string(each.name);
  }
  throw std::invalid_argument("colour image has encoding \"" + encoding + "\", expected one of " + known);
}

/// Bayer patterns and 4:2:2 have pixels in pairs. Demosaicing needs two pairs.
void requireSizeOfPattern(const cv::Mat& raw, const ColourEncoding& encoding) {
  const std::string name = encoding.name;
  const bool is_bayer = name.rfind("bayer", 0) == 0;
  const bool is_yuv = name.rfind("yuv", 0) == 0;
  if ((!is_bayer || (raw.cols > 2 && raw.rows > 2)) && (!is_yuv || raw.cols % 2 == 0)) return;
  throw std::invalid_argument("image of " + std::to_string(raw.cols) + "x" + std::to_string(raw.rows) +
                              " pixels is too small or not even, as " + name + " has to be");
}

}  // namespace

DepthImage toDepthImage(const cv::Mat& raw, const std::string& encoding, double unit, double saturated) {
  const float highest = saturated > 0.0 ? static_cast<float>(saturated) : kNoDepth;
  if (encoding == "16UC1" || encoding == "mono16") {
    requireType(raw, CV_16UC1, encoding);
    return convertDepth<std::uint16_t>(raw, unit, highest);
  }
  if (encoding == "32FC1") {
    requireType(raw, CV_32FC1, encoding);
    return convertDepth<float>(raw, unit, highest);
  }
  throw std::invalid_argument("depth image has encoding \"" + encoding +
                              "\", expected 16UC1 or mono16 (counts of depth_scale), or 32FC1 (m); "
                              "compressed: by compressedDepth, or as "
                              "PNG of 16 bits");
}

GreyImage toGreyImage(const cv::Mat& raw, const std::string& encoding) {
  const ColourEncoding& known = findColourEncoding(encoding);
  requireType(raw, known.type, encoding);
  if (raw.empty()) return {};
  requireSizeOfPattern(raw, known);
  cv::Mat grey;  // not `raw`, into which cvtColor would write if `raw` is a Bayer pattern
  if (known.to_grey == kIsGrey) {
    grey = raw;
  } else {
    cv::cvtColor(raw, grey, known.to_grey);
  }
  if (grey.depth() == CV_16U) {
    cv::Mat bytes;
    grey.convertTo(bytes, CV_8U, 255.0 / 65535.0);
    return bytes;
  }
  return grey;
}

}  // namespace rgbd_sfm_fusion
