// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "rgbd_sfm_fusion/geometry/rolling_shutter.h"
#include "rgbd_sfm_fusion/mapping/inverse_depth.h"
#include "rgbd_sfm_fusion/tracking/image_pyramid.h"

namespace rgbd_sfm_fusion {

/// Keyframe pixels of one pyramid level that have a depth and a gradient: one array per quantity, padded to
/// full blocks with points that are never in view.
struct ReferencePoints {
  PinholeCamera camera;              ///< of the level
  int count = 0;                     ///< points before padding
  std::vector<float> x, y;           ///< ray (x, y, 1) of the pixel, in the keyframe at its middle row
  std::vector<float> inverse_depth;  ///< [1 / tracker unit]
  std::vector<float> inverse_depth_variance;
  std::vector<float> intensity;               ///< [grey levels]
  std::vector<float> gradient_x, gradient_y;  ///< [grey levels / px of the level]
};

/// The data that frames are aligned with: the keyframe's brightness and depth, per pyramid level.
class TrackingReference {
 public:
  /// Starts a new keyframe.
  void setKeyframe(const ImagePyramid& pyramid, const std::vector<PinholeCamera>& cameras);

  /// Collects the points of all levels from `finest` on.
  /// @param depth         full resolution
  /// @param min_gradient  [grey levels / px] least gradient of a point, on its own level
  /// @param motion        of the keyframe while it was read out
  void setDepth(const InverseDepthImage& depth, const ReadoutMotion& motion, float min_gradient, int finest);

  /// @param level  from the `finest` of setDepth() to the coarsest
  const ReferencePoints& points(int level) const { return points_[static_cast<std::size_t>(level)]; }
  int levels() const { return static_cast<int>(points_.size()); }

  /// A copy that frames can be aligned with, but without the images to collect points from.
  TrackingReference pointsOnly() const;

 private:
  std::vector<cv::Mat_<float>> intensity_;
  std::vector<ImageGradient> gradient_;
  std::vector<cv::Rect> seen_;
  std::vector<InverseDepthImage> depth_;
  std::vector<ReferencePoints> points_;
};

}  // namespace rgbd_sfm_fusion
