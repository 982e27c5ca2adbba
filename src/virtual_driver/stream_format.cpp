// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "stream_format.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace rgbd_sfm_fusion {
namespace {

constexpr int kMirror = 1;                // cv::flip's code for "about the vertical axis"
constexpr double kInfraredPerGrey = 4.0;  // infrared images have 10 bits

std::vector<OniVideoMode> modes(OniPixelFormat format, const PinholeCamera& camera, double rate) {
  const int fps = static_cast<int>(std::lround(rate));
  return {{format, camera.width, camera.height, fps}, {format, camera.width / 2, camera.height / 2, fps}};
}

OniSensorInfo info(OniSensorType sensor, std::vector<OniVideoMode>& list) {
  return {sensor, static_cast<int>(list.size()), list.data()};
}

cv::Mat exposed(const cv::Mat& image, const StreamProperties& p) {
  const bool neutral = p.auto_exposure == TRUE || p.exposure * p.gain == p.kNeutral * p.kNeutral;
  if (neutral) return image;
  cv::Mat result;
  image.convertTo(result, -1, 1.0 * p.exposure * p.gain / (p.kNeutral * p.kNeutral));
  return result;
}

cv::Mat infrared(const cv::Mat& rgb) {
  cv::Mat grey, result;
  cv::cvtColor(rgb, grey, cv::COLOR_RGB2GRAY);
  grey.convertTo(result, CV_16U, kInfraredPerGrey);
  return result;
}

cv::Mat resized(const cv::Mat& image, cv::Size size, int interpolation) {
  if (image.size() == size) return image;
  cv::Mat result;
  cv::resize(image, result, size, 0.0, 0.0, interpolation);
  return result;
}

int matType(OniPixelFormat format) {
  return format == ONI_PIXEL_FORMAT_RGB888 ? CV_8UC3 : CV_16UC1;
}

}  // namespace

SensorModes::SensorModes(const PinholeCamera& camera, double rate)
    : colour_(modes(ONI_PIXEL_FORMAT_RGB888, camera, rate)),
      depth_(modes(ONI_PIXEL_FORMAT_DEPTH_1_MM, camera, rate)),
      infrared_(modes(ONI_PIXEL_FORMAT_GRAY16, camera, rate)),
      infos_{info(ONI_SENSOR_COLOR, colour_), info(ONI_SENSOR_DEPTH, depth_),
             info(ONI_SENSOR_IR, infrared_)} {}

const std::vector<OniVideoMode>& SensorModes::of(OniSensorType sensor) const {
  static const std::vector<OniVideoMode> none;
  switch (sensor) {
    case ONI_SENSOR_COLOR:
      return colour_;
    case ONI_SENSOR_DEPTH:
      return depth_;
    case ONI_SENSOR_IR:
      return infrared_;
  }
  return none;
}

int pixelSize(OniPixelFormat format) {
  return static_cast<int>(CV_ELEM_SIZE(matType(format)));
}

void writeImage(const cv::Mat& image, const StreamProperties& properties, void* data) {
  const OniVideoMode& mode = properties.mode;
  const cv::Size size(mode.resolutionX, mode.resolutionY);
  cv::Mat source = image;
  if (mode.pixelFormat == ONI_PIXEL_FORMAT_DEPTH_1_MM) {
    source = resized(image, size, cv::INTER_NEAREST);  // the mean of two surfaces lies on neither
  } else {
    source = resized(exposed(image, properties), size, cv::INTER_AREA);
    if (mode.pixelFormat == ONI_PIXEL_FORMAT_GRAY16) source = infrared(source);
  }
  cv::Mat target(size, matType(mode.pixelFormat), data);
  if (properties.mirrored == TRUE) {
    cv::flip(source, target, kMirror);
  } else {
    source.copyTo(target);
  }
}

}  // namespace rgbd_sfm_fusion
