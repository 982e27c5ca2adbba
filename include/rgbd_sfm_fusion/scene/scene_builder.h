// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "rgbd_sfm_fusion/scene/lighting.h"
#include "rgbd_sfm_fusion/scene/scene.h"

namespace rgbd_sfm_fusion {

/// Collects patches with their reflectance, and then lights them.
class SceneBuilder {
 public:
  /// Paints a surface of `width` x `height` metres, as CV_8UC3, RGB, with texels of the given size [m].
  using Paint = std::function<cv::Mat(double width, double height, double texel)>;

  /// [m] Size of a texel in all that is added from now on: about a pixel when seen from close by.
  void setTexel(double texel) { texel_ = texel; }

  /// @return index of the patch
  std::size_t add(const Patch& patch, const Paint& paint);

  /// A cuboid, without its underside if that is below eye level. Its base is centred at `base`, and turned
  /// about the vertical.
  /// @param size along x, y, z before the turn [m]
  void addBox(const Eigen::Vector3d& base, const Eigen::Vector3d& size, double yaw, const Paint& sides,
              const Paint& top, Material material = Material::kMatte);

  /// Part of a patch as a patch of its own, a millimetre in front of it: the same paint, in the sun.
  void addSunlit(std::size_t patch, const cv::Rect2d& uv);

  void addMirror(const Patch& patch);

  /// Bakes the light into the textures.
  Scene build(const Lighting& lighting) const;

 private:
  double texel_ = 2.5e-3;
  std::vector<Patch> patches_;
  std::vector<cv::Mat> reflectance_;
};

}  // namespace rgbd_sfm_fusion
