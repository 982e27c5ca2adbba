// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <visualization_msgs/Marker.h>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"

namespace rgbd_sfm_fusion {

/// The camera's field of view, as the edges of a pyramid from its centre to `depth` [m] in front of it.
/// @param header  of the colour image
visualization_msgs::Marker toFrustumMarker(const std_msgs::Header& header, const PinholeCamera& camera,
                                           double depth);

}  // namespace rgbd_sfm_fusion
