// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "oni_driver_api.h"
#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"

namespace rgbd_sfm_fusion {

/// The modes of the device's sensors: full and half size. Each sensor has one rate and one format.
class SensorModes {
 public:
  SensorModes(const PinholeCamera& camera, double rate);
  SensorModes(const SensorModes&) = delete;  // the infos point into it
  SensorModes& operator=(const SensorModes&) = delete;

  std::vector<OniSensorInfo>& infos() { return infos_; }

  /// Full size first; empty for a sensor that the device does not have.
  const std::vector<OniVideoMode>& of(OniSensorType sensor) const;

 private:
  std::vector<OniVideoMode> colour_, depth_, infrared_;
  std::vector<OniSensorInfo> infos_;
};

/// What a stream makes of its images, as its properties say.
struct StreamProperties {
  OniVideoMode mode;
  OniBool mirrored = TRUE;  ///< devices of this family mirror when they get power
  OniBool auto_exposure = TRUE;
  OniBool auto_white_balance = TRUE;  ///< has no effect, as the room's light is white
  int exposure = kNeutral;            ///< [%] while auto exposure is off
  int gain = kNeutral;                ///< [%] while auto exposure is off

  static constexpr int kNeutral = 100, kLeast = 1, kMost = 1000;
};

/// Writes a stream's image as its properties want it.
/// @param image full size; CV_8UC3 RGB, CV_16UC1, or CV_8UC3 for a mode of 16 bit grey, which is infrared
/// @param data  room for the mode's width x height pixels
void writeImage(const cv::Mat& image, const StreamProperties& properties, void* data);

/// Bytes of a pixel.
int pixelSize(OniPixelFormat format);

}  // namespace rgbd_sfm_fusion
