// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <mutex>
#include <opencv2/core.hpp>

#include "oni_driver_api.h"
#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "stream_format.h"

namespace rgbd_sfm_fusion {

class FrameSource;

/// Colour, depth or infrared of the virtual device. Its images come from the device's FrameSource.
class VirtualStream : public oni::driver::StreamBase {
 public:
  VirtualStream(OniSensorType sensor, const PinholeCamera& camera, const SensorModes& modes,
                FrameSource& source);

  OniSensorType sensor() const { return sensor_; }

  OniStatus start() override;
  void stop() override;

  OniBool isPropertySupported(int property) override;
  OniStatus getProperty(int property, void* data, int* size) override;
  OniStatus setProperty(int property, const void* data, int size) override;

  /// Hands an image to OpenNI2. Only between start() and stop().
  /// @param image see writeImage()
  /// @param device_time [us]
  void deliver(const cv::Mat& image, std::uint32_t index, std::uint64_t device_time);

 private:
  OniStatus setMode(const OniVideoMode& mode);
  StreamProperties properties() const;

  const OniSensorType sensor_;
  const PinholeCamera camera_;
  const SensorModes& modes_;
  FrameSource& source_;

  mutable std::mutex mutex_;  ///< guards what follows
  StreamProperties properties_;
  bool started_ = false;
};

}  // namespace rgbd_sfm_fusion
