// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "pixel_format.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace rgbd_sfm_fusion {
namespace {

/// Formats that can be read, the best first.
std::vector<openni::PixelFormat> readableFormats(StreamKind stream) {
  switch (stream) {
    case StreamKind::kColour:
      return {openni::PIXEL_FORMAT_RGB888, openni::PIXEL_FORMAT_YUV422, openni::PIXEL_FORMAT_YUYV,
              openni::PIXEL_FORMAT_GRAY8};
    case StreamKind::kDepth:
      return {openni::PIXEL_FORMAT_DEPTH_1_MM, openni::PIXEL_FORMAT_DEPTH_100_UM};
    default:
      return {openni::PIXEL_FORMAT_GRAY16, openni::PIXEL_FORMAT_GRAY8};
  }
}

int matType(openni::PixelFormat format) {
  switch (format) {
    case openni::PIXEL_FORMAT_RGB888:
      return CV_8UC3;
    case openni::PIXEL_FORMAT_YUV422:
    case openni::PIXEL_FORMAT_YUYV:
      return CV_8UC2;
    case openni::PIXEL_FORMAT_GRAY8:
      return CV_8UC1;
    default:
      return CV_16UC1;
  }
}

}  // namespace

bool canRead(StreamKind stream, openni::PixelFormat format) {
  const auto formats = readableFormats(stream);
  return std::find(formats.begin(), formats.end(), format) != formats.end();
}

bool findVideoMode(const openni::SensorInfo& sensor, StreamKind stream, const StreamMode& mode,
                   openni::VideoMode* video_mode) {
  const auto& modes = sensor.getSupportedVideoModes();
  for (const openni::PixelFormat format : readableFormats(stream)) {
    for (int i = 0; i < modes.getSize(); ++i) {
      const StreamMode known{modes[i].getResolutionX(), modes[i].getResolutionY(), modes[i].getFps()};
      if (known != mode || modes[i].getPixelFormat() != format) continue;
      *video_mode = modes[i];
      return true;
    }
  }
  return false;
}

cv::Mat viewPixels(const openni::VideoFrameRef& frame, cv::Mat* converted) {
  const openni::PixelFormat format = frame.getVideoMode().getPixelFormat();
  const int type = matType(format);
  const int stride = frame.getStrideInBytes();
  const int row = frame.getWidth() * static_cast<int>(CV_ELEM_SIZE(type));
  if (frame.getHeight() <= 0 || row <= 0 || stride < row ||
      frame.getDataSize() < stride * (frame.getHeight() - 1) + row)
    throw CameraError("the driver delivers a frame whose size contradicts its " +
                      std::to_string(frame.getDataSize()) + " bytes");
  cv::Mat pixels(frame.getHeight(), frame.getWidth(), type, const_cast<void*>(frame.getData()),
                 static_cast<std::size_t>(stride));
  switch (format) {
    case openni::PIXEL_FORMAT_RGB888:
    case openni::PIXEL_FORMAT_DEPTH_1_MM:
    case openni::PIXEL_FORMAT_GRAY16:
      return pixels;
    case openni::PIXEL_FORMAT_DEPTH_100_UM:
      pixels.convertTo(*converted, CV_16U, 0.1);
      return *converted;
    case openni::PIXEL_FORMAT_YUV422:
      cv::cvtColor(pixels, *converted, cv::COLOR_YUV2RGB_UYVY);
      return *converted;
    case openni::PIXEL_FORMAT_YUYV:
      cv::cvtColor(pixels, *converted, cv::COLOR_YUV2RGB_YUYV);
      return *converted;
    case openni::PIXEL_FORMAT_GRAY8:
      if (frame.getSensorType() == openni::SENSOR_COLOR) {
        cv::cvtColor(pixels, *converted, cv::COLOR_GRAY2RGB);
      } else {
        pixels.convertTo(*converted, CV_16U);
      }
      return *converted;
    default:
      throw CameraError("the driver delivers a pixel format that was not asked for: " +
                        std::to_string(format));
  }
}

}  // namespace rgbd_sfm_fusion
