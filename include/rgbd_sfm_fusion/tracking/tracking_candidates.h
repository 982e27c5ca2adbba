// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "rgbd_sfm_fusion/geometry/rolling_shutter.h"
#include "rgbd_sfm_fusion/image/image_pyramid.h"
#include "rgbd_sfm_fusion/image/inverse_depth.h"
#include "rgbd_sfm_fusion/image/row_bands.h"
#include "rgbd_sfm_fusion/tracking/tracking_reference.h"

namespace rgbd_sfm_fusion {

/// Which gradients are worth tracking: those of even surfaces with noise are not.
struct GradientLimit {
  float least;         ///< [grey levels / px] on each level
  double noise = 0.0;  ///< [grey levels] sigma of a pixel of the image itself

  /// [grey levels / px of the level]
  float onLevel(int level) const;
};

/// The keyframe's pixels whose gradient is large enough to align frames with, per pyramid level. They stay
/// the same for as long as the keyframe does. Those that have a depth make the TrackingReference, which is
/// collected anew whenever depth has changed.
class TrackingCandidates {
 public:
  /// Starts a new keyframe.
  /// @param finest  the finest level that gets points
  void setKeyframe(const ImagePyramid& pyramid, const std::vector<PinholeCamera>& cameras,
                   const GradientLimit& limit, int finest = 0);

  /// Collects the points of all levels.
  /// @param depth   full resolution
  /// @param motion  of the keyframe while it was read out
  /// @param bands   bands of rows in which depth has changed since `before` was collected
  /// @param before  of the same keyframe; its points are copied outside of the bands. Any, if `bands` are all
  /// @param result  overwritten; must not be `before`
  void collect(const InverseDepthImage& depth, const ReadoutMotion& motion, const RowBands& bands,
               const TrackingReference& before, TrackingReference& result);

  /// Candidates on the finest level that has any: alignment ends with as many points, at most.
  int count() const {
    return levels_.empty() ? 0 : static_cast<int>(levels_[static_cast<std::size_t>(finest_)].pixel.size());
  }

 private:
  /// The candidates of a level, in image order.
  struct Level {
    PinholeCamera camera;
    std::vector<int> ends;   // per band of rows of the full image: one past its last candidate
    std::vector<int> pixel;  // v * width + u
    // As in ReferencePoints, but rays are those of the pixel's own row:
    std::vector<float> x, y, intensity, gradient_x, gradient_y;
  };

  static void find(const cv::Mat_<float>& image, const cv::Rect& seen, float min_gradient, int step,
                   const std::vector<cv::Range>& rows, Level& level);
  static void collect(const Level& level, int first, int end, const InverseDepthImage& depth,
                      ReferencePoints& points);

  int finest_ = 0;
  // Per pyramid level:
  std::vector<Level> levels_;
  std::vector<InverseDepthImage> depth_;  // halved; that of level 0 is collect()'s argument
};

}  // namespace rgbd_sfm_fusion
