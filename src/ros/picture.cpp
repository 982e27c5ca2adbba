// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/picture.h"

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/image_encodings.h>
#include <boost/make_shared.hpp>

#include <stdexcept>
#include <string>

namespace rgbd_sfm_fusion {
namespace {

namespace encodings = sensor_msgs::image_encodings;

/// cv_bridge does not convert images whose encoding says the type only.
std::string meaningOf(const std::string& encoding) {
  if (encoding == encodings::TYPE_8UC1) return encodings::MONO8;
  if (encoding == encodings::TYPE_8UC3) return encodings::BGR8;
  return encoding;
}

bool hasColours(const std::string& encoding) {
  return encodings::isColor(encoding) || encodings::isBayer(encoding) ||
         encoding.rfind("yuv", 0) == 0;  // yuv422, and others that cv_bridge may come to know
}

}  // namespace

cv::Mat toPicture(const RawImage& raw) {
  const std::string encoding = meaningOf(raw.encoding);
  const auto image = boost::make_shared<cv_bridge::CvImage>(std_msgs::Header(), encoding, raw.pixels);
  const std::string wanted = hasColours(encoding) ? encodings::RGB8 : encodings::MONO8;
  if (encoding == wanted) return raw.pixels;
  try {
    return cv_bridge::cvtColor(image, wanted)->image;
  } catch (const cv_bridge::Exception& error) {
    throw std::invalid_argument("colour image: " + raw.encoding + " can't be shown: " + error.what());
  }
}

}  // namespace rgbd_sfm_fusion
