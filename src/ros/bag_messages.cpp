// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/bag_messages.h"

#include <ros/serialization.h>
#include <boost/make_shared.hpp>

#include <cstring>
#include <stdexcept>
#include <string>

namespace rgbd_sfm_fusion {
namespace {

/// Calls `read` with a stream of the bytes, and says of which message an error is.
template <class Function>
void parse(const char* type, const std::vector<std::uint8_t>& bytes, Function read) {
  if (bytes.empty()) throw std::invalid_argument(std::string("message of ") + type + " is empty");
  // The stream reads only, but takes no const pointer.
  ros::serialization::IStream stream(const_cast<std::uint8_t*>(bytes.data()),
                                     static_cast<std::uint32_t>(bytes.size()));
  try {
    read(stream);
  } catch (const ros::serialization::StreamOverrunException&) {
    throw std::invalid_argument("message of " + std::to_string(bytes.size()) + " bytes is shorter than the " +
                                type + " that it claims to hold");
  }
}

template <class Element>
void readArray(ros::serialization::IStream& stream, std::vector<Element>* array) {
  std::uint32_t count = 0;
  stream.next(count);
  if (count > stream.getLength() / sizeof(Element)) ros::serialization::throwStreamOverrun();
  array->resize(count);
  const std::uint8_t* elements = stream.advance(static_cast<std::uint32_t>(count * sizeof(Element)));
  if (count > 0) std::memcpy(array->data(), elements, count * sizeof(Element));
}

}  // namespace

sensor_msgs::ImagePtr readImage(const std::vector<std::uint8_t>& bytes) {
  auto image = boost::make_shared<sensor_msgs::Image>();
  parse("image", bytes, [&](ros::serialization::IStream& stream) {
    stream.next(image->header);
    stream.next(image->height);
    stream.next(image->width);
    stream.next(image->encoding);
    stream.next(image->is_bigendian);
    stream.next(image->step);
    readArray(stream, &image->data);
  });
  return image;
}

sensor_msgs::CompressedImage readCompressedImage(const std::vector<std::uint8_t>& bytes) {
  sensor_msgs::CompressedImage image;
  parse("compressed image", bytes, [&](ros::serialization::IStream& stream) {
    stream.next(image.header);
    stream.next(image.format);
    readArray(stream, &image.data);
  });
  return image;
}

sensor_msgs::CameraInfo readCameraInfo(const std::vector<std::uint8_t>& bytes) {
  sensor_msgs::CameraInfo info;
  parse("camera_info", bytes, [&](ros::serialization::IStream& stream) {
    stream.next(info.header);
    stream.next(info.height);
    stream.next(info.width);
    stream.next(info.distortion_model);
    readArray(stream, &info.D);
    stream.next(info.K);
    stream.next(info.R);
    stream.next(info.P);
    stream.next(info.binning_x);
    stream.next(info.binning_y);
    stream.next(info.roi);
  });
  return info;
}

}  // namespace rgbd_sfm_fusion
