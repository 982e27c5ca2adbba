// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/mapping/mapping_options.h"
#include "rgbd_sfm_fusion/sensor/depth_noise.h"
#include "rgbd_sfm_fusion/tracking/tracking_options.h"

namespace rgbd_sfm_fusion {

/// How the map starts (method.md 8).
enum class Initialisation : std::uint8_t {
  kDepth,   ///< from the first sensor depth image: metric at once
  kRandom,  ///< from random depths: scale unknown until fusion has fitted it
};

/// A tracked frame becomes the keyframe when (distance / max_distance)² + (out of view / max_out_of_view)² >
/// 1. Above 16 Hz, it waits while something is in the way (isObstructed()). What is learned of the camera may
/// make it the keyframe before.
struct KeyframeOptions {
  float max_distance = 0.14F;    ///< from the keyframe, in units of the scene's depth
  float max_out_of_view = 0.3F;  ///< share of the keyframe's points
};

struct OdometryOptions {
  DepthNoiseModel noise;  ///< of the sensor
  Initialisation init = Initialisation::kDepth;
  bool sensor_feedback = true;   ///< after a start with depth, track against sensor depth too, so that scale
                                 ///< cannot drift (method.md 9)
  bool compensate_skew = true;   ///< move sensor depth to colour by the tracked motion (method.md 1)
  bool estimate_readout = true;  ///< learn a rolling shutter's readout time from the images (method.md 10)
  float readout_time = 0.0F;     ///< [s] from the first row to the last (negative: from the last to the
                                 ///< first); the start of learning, or the known time without learning; 0:
                                 ///< all rows at once
  bool estimate_depth_delay = true;      ///< learn how much older depth images are than their stamps say, if
                                         ///< compensate_skew and feedsBack() (method.md 10)
  bool estimate_principal_point = true;  ///< learn by how much the calibration's principal point is off, and
                                         ///< use what was learned for poses and stereo (method.md 10)
  TrackingOptions tracking;
  MappingOptions mapping;
  KeyframeOptions keyframe;

  /// Whether frames are aligned with sensor depth: in its unit, that is after a metric start.
  bool feedsBack() const { return sensor_feedback && init == Initialisation::kDepth; }
};

/// @throws std::invalid_argument naming the option that is out of range
void validate(const OdometryOptions& options);
/// @throws std::invalid_argument as above, or if the camera's images are too small
void validate(const OdometryOptions& options, const PinholeCamera& camera);

}  // namespace rgbd_sfm_fusion
