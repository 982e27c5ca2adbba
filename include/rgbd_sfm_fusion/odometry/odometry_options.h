// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace rgbd_sfm_fusion {

/// How the map starts (DESIGN 3.8).
enum class Initialisation : std::uint8_t {
  kDepth,   ///< from the first sensor depth image: metric at once
  kRandom,  ///< from random depths: scale unknown until fusion has fitted it
};

struct OdometryOptions {
  Initialisation init = Initialisation::kDepth;
  bool sensor_feedback = true;  ///< track against sensor depth too, so that scale cannot drift (DESIGN 3.9)
  bool compensate_skew = true;  ///< move sensor depth to the colour stamp by the tracked motion (DESIGN 3.1)
};

}  // namespace rgbd_sfm_fusion
