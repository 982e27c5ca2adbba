// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// [s] For a longer time, the velocity of a hand-held camera does not hold.
constexpr double kLongestMotion = 0.5;

/// A pose of the camera's optical frame in time.
struct StampedPose {
  Stamp stamp = kNoStamp;
  SE3 T_first_camera;
};

/// Motion from the depth image's stamp to `current`'s, at the constant velocity between two tracked frames.
/// @return T_colour_depth, in the unit of the poses. Identity where the velocity is unknown: `previous` has
///         no stamp, `previous` is not within kLongestMotion before `current`, or the depth is not within it
///         of `current`
SE3 motionSinceDepth(const StampedPose& previous, const StampedPose& current, Stamp depth_stamp);

/// Sensor depth as it would have been seen from where the colour image was taken (method.md 1,
/// `compensate_skew`). Points are rounded to pixel centres. Of several points in a pixel, the nearest one is
/// kept. If the warp has torn a one-pixel crack into a surface, the crack is filled from the pixel that
/// belongs there. Nothing is interpolated, and holes stay holes. With the identity, the same image is
/// returned.
///
/// @param depth           [m] H x W, at its own stamp
/// @param T_colour_depth  [m]
/// @param buffer          overwritten and returned, if it has the right size
DepthImage compensateSkew(const DepthImage& depth, const PinholeCamera& camera, const SE3& T_colour_depth,
                          DepthImage buffer = {});

/// Empties the holes of `measured` in `moved`: depth at the rim of a hole is the least certain, and is not
/// moved into the hole.
void keepHoles(const DepthImage& measured, DepthImage& moved);

}  // namespace rgbd_sfm_fusion
