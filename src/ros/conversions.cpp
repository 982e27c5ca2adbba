// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/conversions.h"

#include <boost/make_shared.hpp>

#include <algorithm>
#include <stdexcept>

#include "rgbd_sfm_fusion/input/compressed_image.h"
#include "rgbd_sfm_fusion/input/image_view.h"

namespace rgbd_sfm_fusion {
namespace {

int toInt(const char* field, std::uint32_t pixels) {
  if (pixels <= static_cast<std::uint32_t>(kLongestSide)) return static_cast<int>(pixels);
  throw std::invalid_argument("camera_info: " + std::string(field) + " is " + std::to_string(pixels) +
                              ", expected at most " + std::to_string(kLongestSide) + " px");
}

}  // namespace

std::string withoutSlash(std::string frame) {
  if (!frame.empty() && frame.front() == '/') frame.erase(0, 1);
  return frame;
}

geometry_msgs::Transform toTransform(const SE3& T) {
  geometry_msgs::Transform transform;
  transform.translation.x = T.translation().x();
  transform.translation.y = T.translation().y();
  transform.translation.z = T.translation().z();
  transform.rotation.x = T.rotation().x();
  transform.rotation.y = T.rotation().y();
  transform.rotation.z = T.rotation().z();
  transform.rotation.w = T.rotation().w();
  return transform;
}

geometry_msgs::Pose toPose(const SE3& T) {
  const geometry_msgs::Transform transform = toTransform(T);
  geometry_msgs::Pose pose;
  pose.position.x = transform.translation.x;
  pose.position.y = transform.translation.y;
  pose.position.z = transform.translation.z;
  pose.orientation = transform.rotation;
  return pose;
}

SE3 fromTransform(const geometry_msgs::Transform& transform) {
  const auto& q = transform.rotation;
  const auto& t = transform.translation;
  const Eigen::Quaterniond rotation(q.w, q.x, q.y, q.z);
  const Eigen::Vector3d translation(t.x, t.y, t.z);
  const bool usable =
      rotation.coeffs().allFinite() && translation.allFinite() && rotation.squaredNorm() > 0.0;
  if (!usable)
    throw std::invalid_argument("transform: expected finite numbers and a quaternion that is not zero");
  return {rotation, translation};
}

CameraCalibration toCalibration(const sensor_msgs::CameraInfo& info) {
  CameraCalibration calibration;
  calibration.width = toInt("width", info.width);
  calibration.height = toInt("height", info.height);
  calibration.distortion_model = info.distortion_model;
  calibration.D.assign(info.D.begin(), info.D.end());
  std::copy(info.K.begin(), info.K.end(), calibration.K.begin());
  std::copy(info.R.begin(), info.R.end(), calibration.R.begin());
  std::copy(info.P.begin(), info.P.end(), calibration.P.begin());
  ImageSection section;
  section.x = toInt("roi.x_offset", info.roi.x_offset);
  section.y = toInt("roi.y_offset", info.roi.y_offset);
  section.width = toInt("roi.width", info.roi.width);
  section.height = toInt("roi.height", info.roi.height);
  section.binning_x = toInt("binning_x", info.binning_x);
  section.binning_y = toInt("binning_y", info.binning_y);
  return ofSection(calibration, section);
}

sensor_msgs::CameraInfo toCameraInfo(const std_msgs::Header& header, const PinholeCamera& camera) {
  sensor_msgs::CameraInfo info;
  info.header = header;
  info.width = static_cast<std::uint32_t>(camera.width);
  info.height = static_cast<std::uint32_t>(camera.height);
  info.distortion_model = "plumb_bob";
  info.D.assign(5, 0.0);
  info.K = {camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0};
  info.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info.P = {camera.fx, 0.0, camera.cx, 0.0, 0.0, camera.fy, camera.cy, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

void fillImage(const std_msgs::Header& header, const std::string& encoding, const cv::Mat& pixels,
               sensor_msgs::Image* image) {
  if (!pixels.isContinuous()) return fillImage(header, encoding, pixels.clone(), image);
  image->header = header;
  image->height = static_cast<std::uint32_t>(pixels.rows);
  image->width = static_cast<std::uint32_t>(pixels.cols);
  image->encoding = encoding;
  image->is_bigendian = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__ ? 1 : 0;
  const std::size_t step = static_cast<std::size_t>(pixels.cols) * pixels.elemSize();
  image->step = static_cast<std::uint32_t>(step);
  // Not by resize(), which writes zeros first: these are 5 MB of each frame.
  image->data.assign(pixels.data, pixels.data + static_cast<std::size_t>(pixels.rows) * step);
}

sensor_msgs::ImagePtr toImage(const std_msgs::Header& header, const std::string& encoding,
                              const cv::Mat& pixels) {
  auto image = boost::make_shared<sensor_msgs::Image>();
  fillImage(header, encoding, pixels, image.get());
  return image;
}

sensor_msgs::ImagePtr decompress(const sensor_msgs::CompressedImage& image) {
  const DecodedImage decoded = decodeImage({image.format, image.data.data(), image.data.size()});
  return toImage(image.header, decoded.encoding, decoded.pixels);
}

cv::Mat viewImage(const sensor_msgs::ImageConstPtr& image) {
  return viewPixels({image->width, image->height, image->step, image->encoding, image->is_bigendian != 0,
                     image->data.data(), image->data.size()});
}

RawImage toRawImage(const sensor_msgs::ImageConstPtr& image, Stamp stamp) {
  if (!image) return {};
  return {stamp, image->encoding, viewImage(image)};
}

}  // namespace rgbd_sfm_fusion
