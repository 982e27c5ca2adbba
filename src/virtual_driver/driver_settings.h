// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "rgbd_sfm_fusion/scene/virtual_camera.h"

namespace rgbd_sfm_fusion {

/// From this time on, the device is there, or gone.
struct PlugEvent {
  double time;  ///< [s] since the driver was loaded
  bool plugged;
};

/// During a stall no image comes; those that were due are lost.
struct Stall {
  double time;      ///< [s] since the driver was loaded
  double duration;  ///< [s]
};

/// What the virtual device is and does. It is read from the environment variable kSettingsVariable.
struct DriverSettings {
  VirtualCameraOptions camera;
  double start = 0.0;  ///< [s] along the trajectory, where the first stream starts
  double depth_camera_offset =
      -0.025;  ///< [m] the depth camera is this far to the right of colour's, as in an Astra
  std::string serial = "VIRTUAL0001";
  std::vector<PlugEvent> plug_events;  ///< in order of time; plugging and unplugging take turns
  std::vector<Stall> stalls;
  double drop = 0.0;          ///< probability that an image of a stream is lost
  double jitter = 0.0;        ///< [s] images are delivered up to this late
  double clock_offset = 0.0;  ///< [s] what the device's clock shows when it is plugged in
  double clock_drift = 0.0;   ///< seconds that it gains per second
  int failing_starts = 0;     ///< so many starts of streams fail before they work
  std::string lock;           ///< file that an open device holds with flock(), unless empty
  std::string log;            ///< file that gets a line for every delivered colour image, unless empty

  bool pluggedAtLoad() const { return plug_events.empty() || !plug_events.front().plugged; }
};

constexpr const char* kSettingsVariable = "RGBD_SFM_FUSION_VIRTUAL_CAMERA";

/// @param text `key=value` separated by white space; if a key is there twice, the last one counts. The keys
///        are listed in docs/virtual_camera.md
/// @throws std::invalid_argument naming the key, its value and what was expected
DriverSettings parseDriverSettings(const std::string& text);

}  // namespace rgbd_sfm_fusion
