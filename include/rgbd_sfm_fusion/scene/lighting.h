// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "rgbd_sfm_fusion/scene/scene.h"

namespace rgbd_sfm_fusion {

/// A rectangular lamp or window: its light falls off with the square of the distance.
struct AreaLight {
  Eigen::Vector3d origin;
  Eigen::Vector3d edge_u;
  Eigen::Vector3d edge_v;
  double power;  ///< brightness of a white surface that faces it from 1 m [of white = 1]
};

struct Lighting {
  std::vector<AreaLight> lights;
  double ambient = 0.1;  ///< light from everywhere [of white = 1]
  double sun = 1.0;      ///< what sunlit surfaces get on top [of white = 1]
};

/// Display brightness of a white surface over a patch, shadows of the other patches included.
/// @return CV_32FC1 on a grid of about 8 cm; cells are areas, as in an image of the patch
cv::Mat lightMap(const std::vector<Patch>& patches, std::size_t patch, const Lighting& lighting);

}  // namespace rgbd_sfm_fusion
