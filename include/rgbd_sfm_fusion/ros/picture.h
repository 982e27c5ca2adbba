// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/pipeline/frame_preparation.h"

namespace rgbd_sfm_fusion {

/// The colour image for people. Rectified, it is published as /fusion/image_rect.
/// @return RGB for every encoding that has colours, else 8 bit grey; shares its pixels with `raw` if it can
/// @throws std::invalid_argument for an encoding that cv_bridge can't convert
cv::Mat toPicture(const RawImage& raw);

}  // namespace rgbd_sfm_fusion
