// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/calibration_file.h"

#include <camera_calibration_parsers/parse.h>
#include <ros/package.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/tools/paths.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::uintmax_t kLargestFile = 1U << 20U;  // [bytes]

bool startsWith(const std::string& text, const std::string& start) {
  return text.compare(0, start.size(), start) == 0;
}

std::string toPath(const std::string& place) {
  const std::string file = "file://", package = "package://";
  if (startsWith(place, file)) return place.substr(file.size());
  if (startsWith(place, package)) {
    const std::size_t slash = place.find('/', package.size());
    const std::string name = place.substr(package.size(), slash - package.size());
    const std::string folder = ros::package::getPath(name);
    if (folder.empty() || slash == std::string::npos)
      throw std::runtime_error(place + ": there is no package '" + name + "', or no file named in it");
    return folder + place.substr(slash);
  }
  if (place.find("://") != std::string::npos)
    throw std::runtime_error(place + ": expected a path, file:///… or package://…");
  return withHome(place);
}

void requireReadable(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    throw std::runtime_error(path + ": there is no such file");
  if (std::filesystem::file_size(path, error) > kLargestFile)
    throw std::runtime_error(path + ": is larger than 1 MB, expected a camera's calibration");
  errno = 0;
  if (!std::ifstream(path)) throw std::runtime_error(path + ": " + std::strerror(errno));
}

}  // namespace

CameraCalibration readCalibrationFile(const std::string& place) {
  const std::string path = toPath(place);
  requireReadable(path);
  sensor_msgs::CameraInfo info;
  std::string name;
  bool is_read = false;
  try {
    is_read = camera_calibration_parsers::readCalibration(path, name, info);
  } catch (const std::exception&) {  // as if it were not read
  }
  if (!is_read)
    throw std::runtime_error(path +
                             ": is no calibration, expected a .yaml (or .ini) file with image_width, "
                             "image_height, camera_matrix, distortion_model and distortion_coefficients, as "
                             "camera_calibration and camera_info_manager write it");
  try {
    const CameraCalibration calibration = toCalibration(info);
    validate(calibration);
    return calibration;
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
}

}  // namespace rgbd_sfm_fusion
