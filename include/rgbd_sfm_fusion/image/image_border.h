// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// The part of an image inside a border of one brightness, as letterboxing leaves it, or the registration to
/// another camera. The edge of such a border is sharp, and does not move with the scene.
/// @param seen  part of the image to look at
/// @return a part of `seen`; `seen` itself if there is no border, or if the border would be most of it
cv::Rect insideBorder(const GreyImage& grey, const cv::Rect& seen);

}  // namespace rgbd_sfm_fusion
