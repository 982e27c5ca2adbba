// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "rgbd_sfm_fusion/scene/virtual_camera.h"

namespace rgbd_sfm_fusion {

/// A time from which on the device is there, or gone.
struct PlugEvent {
  double time;  ///< [s] since the driver was loaded
  bool plugged;
};

/// No image comes during a stall; what was due is lost.
struct Stall {
  double time;      ///< [s] since the driver was loaded
  double duration;  ///< [s]
};

/// What the virtual device is and does. The environment variable kSettingsVariable says it as text.
struct DriverSettings {
  VirtualCameraOptions camera;
  double start = 0.0;  ///< [s] of the trajectory, at the first start of a stream
  double depth_camera_offset =
      -0.025;  ///< [m] of the depth camera from colour's, to the right; as an Astra's
  std::string serial = "VIRTUAL0001";
  std::vector<PlugEvent> plug_events;  ///< by rising time; plugged and unplugged take turns
  std::vector<Stall> stalls;
  double drop = 0.0;          ///< probability with which an image of a stream is lost
  double jitter = 0.0;        ///< [s] images are delivered up to this late
  double clock_offset = 0.0;  ///< [s] what the device's clock shows when it is plugged in
  double clock_drift = 0.0;   ///< seconds that it gains per second
  int failing_starts = 0;     ///< of streams, until they work
  std::string lock;           ///< file that an open device holds with flock(), unless empty
  std::string log;            ///< file that gets a line for every delivered colour image, unless empty

  bool pluggedAtLoad() const { return plug_events.empty() || !plug_events.front().plugged; }
};

constexpr const char* kSettingsVariable = "RGBD_SFM_FUSION_VIRTUAL_CAMERA";

/// @param text `key=value` separated by white space; of a key that is there twice, the last one counts. The
///        keys are listed in docs/virtual_camera.md
/// @throws std::invalid_argument naming the key, its value and what was expected
DriverSettings parseDriverSettings(const std::string& text);

}  // namespace rgbd_sfm_fusion
