// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <opencv2/core.hpp>
#include <vector>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/rolling_shutter.h"
#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// [σ] Chance makes smaller errors: 0.3 % of Gaussian errors exceed it.
constexpr float kLargestByChance = 3.0F;
/// [σ²] Estimates of one surface differ by less.
constexpr float kOneSurface = kLargestByChance * kLargestByChance;
/// [1] Least step between two surfaces, relative to depth: neighbours whose depths differ by less may be of
/// one.
constexpr float kSurfaceStep = 0.05F;

/// Of an inverse depth that is carried to another image: added to it, as the centre of the pixel that gets it
/// is beside the projection.
constexpr float kCarriedRelativeSigma = 0.02F;

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
  /// Over the pixels that have an estimate; 0 if there are none.
  double meanInverseDepth() const {
    const int count = cv::countNonZero(mean);
    return count > 0 ? cv::sum(mean)[0] / count : 0.0;
  }
};

/// Where an InverseDepthWarp takes points, one array per quantity.
struct WarpedPoints {
  std::vector<float> u, v;  ///< [px] the projection
  std::vector<int> pixel;   ///< v * width + u, nearest to it; -1: behind the camera or out of view
  std::vector<float> inverse_depth;
  std::vector<float> derivative;  ///< of inverse_depth by the inverse depth that was carried

  void resize(std::size_t count);
};

/// Carries inverse depths of one camera's pixels to another pose of that camera, rounded to pixels.
class InverseDepthWarp {
 public:
  /// @param T_to_from  between the images' middle rows
  /// @param from, to   motion of the camera while the images were read out
  InverseDepthWarp(const PinholeCamera& camera, const SE3& T_to_from, const ReadoutMotion& from,
                   const ReadoutMotion& to);

  /// Carries `count` points of a row.
  /// @param columns, inverse_depths  of the points
  /// @param first   index in `points` of the first point
  /// @param points  large enough
  void row(int row, const int* columns, const float* inverse_depths, std::size_t count, std::size_t first,
           WarpedPoints& points) const;

  /// What the hot loop needs.
  struct Terms {
    float R[9], t[3];                          // row-major
    float from_velocity[3], from_rotation[3];  // motion during the readout
    float to_velocity[3], to_rotation[3];
    float fx, fy, cx, cy;
    int width, height;
  };

 private:
  Terms terms_;
};

}  // namespace rgbd_sfm_fusion
