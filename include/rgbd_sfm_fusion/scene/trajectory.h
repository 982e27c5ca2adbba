// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "rgbd_sfm_fusion/geometry/se3.h"

namespace rgbd_sfm_fusion {

/// A camera that somebody holds in both hands while strolling through the room of makeRoom() and looking
/// around: a slow loop, the sway of the arms, and a small tremor. It moves sideways from the first moment,
/// so that there is parallax at once.
///
/// World: z up, metres. The motion has a period of kPeriod and is smooth across it (a sum of its harmonics).
class HandheldTrajectory {
 public:
  static constexpr double kPeriod = 20.0;  ///< [s]

  /// @param seed varies amplitudes and phases
  explicit HandheldTrajectory(std::uint64_t seed);

  /// Pose of the optical frame (x right, y down, z forward).
  /// @param time [s], any finite value
  SE3 T_world_camera(double time) const;

 private:
  struct Harmonic {
    double cycles;     ///< per period, whole
    double amplitude;  ///< [m] or [rad]
    double phase;      ///< [rad]
  };
  /// One coordinate of the motion: an offset, the stroll, two of sway, one of tremor.
  struct Coordinate {
    double offset;
    std::array<Harmonic, 4> harmonics;
    double at(double time) const;
  };

  std::array<Coordinate, 6> coordinates_;  ///< x, y, z [m], yaw, pitch, roll [rad]
};

}  // namespace rgbd_sfm_fusion
