// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "camera_publisher.h"

#include <ros/console.h>
#include <boost/make_shared.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "rgbd_sfm_fusion/camera/default_intrinsics.h"
#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/stamp.h"

namespace rgbd_sfm_fusion {
namespace {

/// camera_info_manager accepts letters, digits and underscores.
std::string toCameraName(std::string name) {
  const auto is_allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  };
  std::replace_if(
      name.begin(), name.end(), [&](char c) { return !is_allowed(c); }, '_');
  return name;
}

/// The path of a file:// URL if there is no such file, else nothing.
std::string missingFile(const std::string& url) {
  const std::string scheme = "file://";
  if (url.rfind(scheme, 0) != 0) return "";
  const std::string path = url.substr(scheme.size());
  return std::filesystem::exists(path) ? "" : path;
}

}  // namespace

CameraCalibrationSource::CameraCalibrationSource(const ros::NodeHandle& handle, const std::string& name,
                                                 const std::string& url)
    : name_(name), url_(url), manager_(ros::NodeHandle(handle, name), name) {}

void CameraCalibrationSource::deviceChanged(const std::string& serial) {
  const std::string name = toCameraName(serial.empty() ? name_ : name_ + "_" + serial);
  if (name == loaded_) return;
  loaded_ = name;
  manager_.setCameraName(name);
  has_warned_ = false;
  // Most cameras have none, which camera_info_manager would warn of.
  const std::string missing = missingFile(manager_.resolveURL(url_, name));
  if (missing.empty()) {
    manager_.loadCameraInfo(url_);
  } else {
    ROS_INFO("%s is not calibrated (there is no %s): the driver's field of view is used", name_.c_str(),
             missing.c_str());
  }
}

sensor_msgs::CameraInfo CameraCalibrationSource::info(const cv::Size& size, double horizontal_fov) {
  sensor_msgs::CameraInfo info = manager_.getCameraInfo();
  const bool is_calibrated = info.K[0] != 0.0;
  const bool fits =
      static_cast<int>(info.width) == size.width && static_cast<int>(info.height) == size.height;
  if (is_calibrated && fits) return info;
  if (is_calibrated && !has_warned_) {
    has_warned_ = true;
    ROS_WARN("the calibration of %s is for %ux%u, but images are %dx%d: the driver's field of view is used",
             name_.c_str(), info.width, info.height, size.width, size.height);
  }
  return toCameraInfo({}, defaultIntrinsics(size.width, size.height, horizontal_fov));
}

CameraPublisher::CameraPublisher(image_transport::ImageTransport* transport, const std::string& name,
                                 const std::string& frame_id, const std::string& encoding,
                                 CameraCalibrationSource* calibration, const std::function<void()>& changed)
    : frame_id_(frame_id), encoding_(encoding), calibration_(calibration) {
  const auto image_changed = [changed](const image_transport::SingleSubscriberPublisher&) { changed(); };
  const auto info_changed = [changed](const ros::SingleSubscriberPublisher&) { changed(); };
  constexpr std::uint32_t kQueueSize = 5;
  publisher_ = transport->advertiseCamera(name + "/image_raw", kQueueSize, image_changed, image_changed,
                                          info_changed, info_changed);
}

void CameraPublisher::publish(const CameraFrame& frame, double offset) {
  std_msgs::Header header;
  header.stamp = toRosTime(frame.stamp + static_cast<Stamp>(std::llround(1e9 * offset)));
  header.frame_id = frame_id_;
  auto info = boost::make_shared<sensor_msgs::CameraInfo>(
      calibration_->info(frame.image.size(), frame.horizontal_fov));
  info->header = header;
  publisher_.publish(toImage(header, encoding_, frame.image), info);
}

}  // namespace rgbd_sfm_fusion
