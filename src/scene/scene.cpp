// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/scene/scene.h"

namespace rgbd_sfm_fusion {

std::optional<Hit> intersect(const std::vector<Patch>& patches, const Eigen::Vector3d& start,
                             const Eigen::Vector3d& direction, double nearest) {
  std::optional<Hit> first;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const Patch& patch = patches[i];
    const Eigen::Vector3d away = patch.edge_u.cross(patch.edge_v);  // from the viewer, not unit length
    const double slope = away.dot(direction);
    if (slope <= 0.0) continue;  // seen from behind
    const Eigen::Vector3d offset = patch.origin - start;
    const double distance = away.dot(offset) / slope;
    if (distance <= nearest || (first && distance >= first->distance)) continue;
    const Eigen::Vector3d in_patch = distance * direction - offset;
    const double area_squared = away.squaredNorm();
    const double u = in_patch.cross(patch.edge_v).dot(away) / area_squared;
    const double v = patch.edge_u.cross(in_patch).dot(away) / area_squared;
    if (u >= 0.0 && u <= 1.0 && v >= 0.0 && v <= 1.0) first = Hit{i, distance, u, v};
  }
  return first;
}

}  // namespace rgbd_sfm_fusion
