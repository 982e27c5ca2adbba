// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "rgbd_sfm_fusion/scene/material.h"
#include "rgbd_sfm_fusion/scene/mip_texture.h"

namespace rgbd_sfm_fusion {

/// A parallelogram in space: origin + u * edge_u + v * edge_v with u, v in [0, 1]. Seen from its front,
/// edge_u points right and edge_v down, as the columns and rows of its texture; from behind it is invisible.
struct Patch {
  Eigen::Vector3d origin;  ///< [m]
  Eigen::Vector3d edge_u;  ///< [m]
  Eigen::Vector3d edge_v;  ///< [m]
  Material material = Material::kMatte;

  /// Unit vector towards those who can see the patch.
  Eigen::Vector3d normal() const { return edge_v.cross(edge_u).normalized(); }
};

/// Where a ray meets a patch, at start + distance * direction.
struct Hit {
  std::size_t patch;
  double distance;  ///< in lengths of the ray's direction
  double u;
  double v;
};

/// Textured patches. Light and shade are part of the textures, as all surfaces but the mirror are matte to
/// the eye: a point has the same brightness from wherever it is seen.
struct Scene {
  std::vector<Patch> patches;
  std::vector<MipTexture> textures;   ///< one for each patch; the mirror's is not used
  std::optional<std::size_t> mirror;  ///< index of the only patch of material kMirror
};

/// The patch that is met first at a distance of more than `nearest`. Slow and simple: it serves light and
/// tests, not images.
std::optional<Hit> intersect(const std::vector<Patch>& patches, const Eigen::Vector3d& start,
                             const Eigen::Vector3d& direction, double nearest = 1e-9);

}  // namespace rgbd_sfm_fusion
