// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "rgbd_sfm_fusion/scene/rasteriser.h"
#include "rgbd_sfm_fusion/scene/scene.h"

namespace rgbd_sfm_fusion {

/// Blends the surfaces that share pixel (x, y), by how much of it each of them covers.
/// @param rgbx colour of the surface in the pixel's centre, replaced by that of the whole pixel
void smoothOutline(const Scene& scene, const GeometryBuffer& geometry, int x, int y, cv::Vec4b& rgbx);

}  // namespace rgbd_sfm_fusion
