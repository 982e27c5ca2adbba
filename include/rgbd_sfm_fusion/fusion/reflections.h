// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "rgbd_sfm_fusion/fusion/sfm_points.h"
#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Drops SfM depth of things that are seen in a mirror or through a pane: the glass is an obstacle nearer
/// than they are. Structured light does not come back from glass, so the sensor's depth has a hole there. A
/// hole is taken for a mirror if
/// - a band of 24 px around it is in one plane, on all sides that are in the image. A doorway is no such
///   hole: the floor in front of its threshold or behind it is not in that plane;
/// - most of SfM's depth in it is behind that plane. A dark picture leaves a hole, too, but there SfM's depth
///   lies in the plane;
/// - SfM's depth could be the image of something real. A point that is mirrored at the plane gives the place
///   of the real thing. If the sensor now looks through that place, the hole is an opening. A place out of
///   view says nothing.
///
/// The lower edge of the image may hide a floor, so a hole that this edge cuts off is left alone. This
/// assumes that the camera is held roughly upright. Limit: an opening with a flat rim all around, as a hatch
/// or an open window, is taken for a mirror if it opens to things beyond the sensor's range, and if the
/// camera is so close that the mirrored places are out of view.
///
/// @param sensor    [m] H x W, NaN = none
/// @param measured  1 where `sensor` has depth, else 0
/// @param sfm       aligned
/// @return          cells of the image that are taken for mirrors
std::vector<cv::Rect> dropReflections(const PinholeCamera& camera, const DepthImage& sensor,
                                      const cv::Mat_<std::uint8_t>& measured, SfmPoints& sfm);

}  // namespace rgbd_sfm_fusion
