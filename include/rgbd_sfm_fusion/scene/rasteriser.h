// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/scene/scene.h"

namespace rgbd_sfm_fusion {

/// at(x, y) = constant + dx * x + dy * y over pixel coordinates.
struct AffineForm {
  double constant = 0.0;
  double dx = 0.0;
  double dy = 0.0;
  double at(double x, double y) const { return constant + dx * x + dy * y; }
};

/// A patch as a camera sees it. On the image of a plane, 1/Z, u/Z and v/Z are affine in the pixel: nothing
/// else is needed for depth, texture coordinates, outline and clipping, and all of it is exact.
struct ProjectedPatch {
  AffineForm inverse_depth;  ///< 1/Z [1/m]
  AffineForm u;              ///< u/Z
  AffineForm v;              ///< v/Z
  bool visible = false;      ///< faces the camera
  int first_row = 0;
  int last_row = -1;
};

/// What is seen in each pixel's centre.
struct GeometryBuffer {
  static constexpr std::int32_t kNothing = -1;

  cv::Mat_<float> inverse_depth;         ///< [1/m], 0 = nothing; where the mirror is, of its glass
  cv::Mat_<std::int32_t> surface;        ///< index into `surfaces`; in the mirror, the mirrored patch
  std::vector<ProjectedPatch> surfaces;  ///< all patches, then all of them mirrored
  std::size_t patch_count = 0;

  /// Whether `surface` is seen in the mirror.
  bool mirrored(std::int32_t surface_index) const {
    return surface_index >= static_cast<std::int32_t>(patch_count);
  }

  const MipTexture& textureOf(const Scene& scene, std::int32_t surface_index) const {
    return scene.textures[static_cast<std::size_t>(surface_index) % patch_count];
  }
};

/// Draws scenes as seen by a pinhole camera. Keeps its buffers from frame to frame.
class Rasteriser {
 public:
  /// @param buffer what it holds is replaced; its memory is used again
  void draw(const Scene& scene, const PinholeCamera& camera, const SE3& T_world_camera,
            GeometryBuffer& buffer);

 private:
  void drawMirror(const Scene& scene, const PinholeCamera& camera, GeometryBuffer& buffer);

  cv::Mat_<float> mirror_inverse_depth_;
  cv::Mat_<std::int32_t> mirror_surface_;
};

}  // namespace rgbd_sfm_fusion
