// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Removes SfM depth of what is seen in a mirror or through a pane, where an obstacle is nearer than what it
/// shows. Structured light does not come back from glass: it leaves a hole in the sensor's depth. A hole is
/// taken for a mirror if
/// - a band of 24 px around it is in one plane, on all sides that are in the image. A doorway is no such
///   hole: below it there is a floor, before its threshold or behind it;
/// - most of what SfM sees in it is behind that plane. Of a dark picture SfM's depth lies in the plane;
/// - what SfM sees could be the image of something real. Mirrored at the plane it is where that would be; if
///   the sensor, now, looks through that place, the hole is an opening. Out of view, nothing is said.
///
/// The lower edge of the image may hide a floor: a hole that it cuts off is left alone, so that the camera is
/// taken to be held upright, roughly. An opening with a flat rim all around, as a hatch or an open window, to
/// what is beyond the sensor's range cannot be told from a mirror where the camera is so close to it that the
/// mirrored things are out of view. It is taken for one.
///
/// @param sensor  [m] H x W, NaN = none
/// @param sfm     [m] H x W, NaN = none; changed where the sensor has nothing
/// @return        cells of the image that are taken for mirrors
std::vector<cv::Rect> removeReflections(const PinholeCamera& camera, const DepthImage& sensor,
                                        GaussianDepth& sfm);

}  // namespace rgbd_sfm_fusion
