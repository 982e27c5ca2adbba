// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <opencv2/core.hpp>
#include <optional>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/rolling_shutter.h"
#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/image_pool.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Per-pixel Gaussian inverse depth N(ρ, σ²_ρ) [1 / tracker unit]. A pixel without an estimate has inverse
/// depth 0 and variance infinity (weight zero), so that weighted sums need no branch.
struct InverseDepthImage {
  cv::Mat_<float> mean, variance;

  void create(const cv::Size& size) {
    mean.create(size);
    variance.create(size);
  }
  void clear() {
    mean.setTo(0.0);
    variance.setTo(std::numeric_limits<double>::infinity());
  }
};

/// The same Gaussians as depth, to first order in σ_ρ/ρ (method.md 2): μ = 1/ρ, σ² = σ²_ρ/ρ⁴.
/// @param pool  the result's images are taken from it
GaussianDepth toDepth(const InverseDepthImage& inverse_depth, ImagePool& pool);

/// Carries inverse depths of one camera's pixels to another pose of that camera, rounded to pixels.
class InverseDepthWarp {
 public:
  /// @param T_to_from  between the images' middle rows
  /// @param from, to   motion of the camera while the images were read out
  InverseDepthWarp(const PinholeCamera& camera, const SE3& T_to_from, const ReadoutMotion& from,
                   const ReadoutMotion& to);

  struct Point {
    int column = 0, row = 0;   ///< the pixel nearest to the projection
    float u = 0.0F, v = 0.0F;  ///< [px] the projection itself
    float inverse_depth = 0.0F;
    float derivative = 0.0F;  ///< of inverse_depth by the inverse depth that was carried
  };

  /// @return nothing where the point is behind the camera or out of view
  std::optional<Point> operator()(int column, int row, float inverse_depth) const;

 private:
  Eigen::Matrix3f R_;
  Eigen::Vector3f t_;
  Eigen::Vector3f from_velocity_, from_rotation_, to_velocity_, to_rotation_;
  float fx_, fy_, cx_, cy_;
  int width_, height_;
};

}  // namespace rgbd_sfm_fusion
