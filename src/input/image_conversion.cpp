// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/image_conversion.h"

#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace rgbd_sfm_fusion {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

void requireType(const cv::Mat& raw, int type, const std::string& encoding) {
  if (raw.type() != type)
    throw std::invalid_argument("image does not hold " + encoding + ", which its encoding names");
}

/// A division, not a product with 0.001: then 16UC1 and 32FC1 of the same depth give the same bits.
float metres(std::uint16_t millimetres) {
  const float depth = static_cast<float>(millimetres) / 1000.0f;
  return depth > 0.0f ? depth : kNaN;
}

float metres(float depth) {
  return depth > 0.0f && depth <= std::numeric_limits<float>::max() ? depth : kNaN;
}

template <class Raw>
DepthImage convertDepth(const cv::Mat& raw) {
  DepthImage depth(raw.size());
  for (int y = 0; y < raw.rows; ++y) {
    const Raw* in = raw.ptr<Raw>(y);
    float* out = depth[y];
    for (int x = 0; x < raw.cols; ++x) out[x] = metres(in[x]);
  }
  return depth;
}

}  // namespace

DepthImage toDepthImage(const cv::Mat& raw, const std::string& encoding) {
  if (encoding == "16UC1") {
    requireType(raw, CV_16UC1, encoding);
    return convertDepth<std::uint16_t>(raw);
  }
  if (encoding == "32FC1") {
    requireType(raw, CV_32FC1, encoding);
    return convertDepth<float>(raw);
  }
  throw std::invalid_argument("depth image has encoding \"" + encoding +
                              "\", expected 16UC1 (mm) or 32FC1 (m)");
}

GreyImage toGreyImage(const cv::Mat& raw, const std::string& encoding) {
  if (encoding == "mono8") {
    requireType(raw, CV_8UC1, encoding);
    return raw;
  }
  if (encoding != "rgb8" && encoding != "bgr8")
    throw std::invalid_argument("colour image has encoding \"" + encoding +
                                "\", expected rgb8, bgr8 or mono8");
  requireType(raw, CV_8UC3, encoding);
  GreyImage grey;
  if (!raw.empty()) cv::cvtColor(raw, grey, encoding == "rgb8" ? cv::COLOR_RGB2GRAY : cv::COLOR_BGR2GRAY);
  return grey;
}

}  // namespace rgbd_sfm_fusion
