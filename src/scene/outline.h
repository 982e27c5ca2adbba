// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "rgbd_sfm_fusion/scene/rasteriser.h"
#include "rgbd_sfm_fusion/scene/scene.h"

namespace rgbd_sfm_fusion {

/// Blends the surfaces that share pixel (x, y), by how much of it each of them covers.
/// @param rgbx colours of the surfaces in the pixels' centres
cv::Vec3b smoothedOutline(const Scene& scene, const GeometryBuffer& geometry, const cv::Mat_<cv::Vec4b>& rgbx,
                          int x, int y);

}  // namespace rgbd_sfm_fusion
