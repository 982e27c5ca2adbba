// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <OpenNI.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <optional>
#include <string>
#include <thread>

#include "driver_settings.h"

namespace rgbd_sfm_fusion {

/// OpenNI2 with the virtual camera as its only driver, from construction to destruction.
class OpenNI2Session {
 public:
  explicit OpenNI2Session(const std::string& settings) {
    setenv(kSettingsVariable, settings.c_str(), 1);
    status = openni::OpenNI::initialize();
  }
  ~OpenNI2Session() { openni::OpenNI::shutdown(); }
  OpenNI2Session(const OpenNI2Session&) = delete;
  OpenNI2Session& operator=(const OpenNI2Session&) = delete;

  openni::Status status;
};

/// Waits up to 10 s.
template <class Condition>
bool becomesTrue(const Condition& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

/// The next frame of a stream, if it comes within 10 s.
inline std::optional<openni::VideoFrameRef> nextFrame(openni::VideoStream& stream) {
  openni::VideoStream* streams[] = {&stream};
  int ready = -1;
  openni::VideoFrameRef frame;
  if (openni::OpenNI::waitForAnyStream(streams, 1, &ready, 10000) != openni::STATUS_OK) return std::nullopt;
  if (stream.readFrame(&frame) != openni::STATUS_OK) return std::nullopt;
  return frame;
}

}  // namespace rgbd_sfm_fusion
