// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "rgbd_sfm_fusion/geometry/depth_warp.h"
#include "rgbd_sfm_fusion/geometry/row_points.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Depth of a pixel while it is reprojected.
struct Estimate {
  float z, variance;
};

/// Whether both are of one surface, as far as the variances can tell. False where there is no depth.
inline bool sameSurface(const Estimate& a, const Estimate& b, float sigmas_squared) {
  const float difference = a.z - b.z;
  return difference * difference <= sigmas_squared * (a.variance + b.variance);
}

inline void warpPoints(const DepthWarp& warp, int y, RowPoints* points) {
  warp.points(y, points->columns.data(), points->values.data(), static_cast<int>(points->count),
              points->pixels.data(), points->z.data());
}

/// Closes the gaps between neighbours of one surface: a gap gets the depth of the source pixel that belongs
/// there. Depth that shines through a gap is removed, unless it comes from that very source pixel.
class GapCloser {
 public:
  GapCloser(const GaussianDepth& source, const DepthWarp& to_target, const DepthWarp& to_source,
            float sigmas_squared)
      : source_(source),
        to_target_(to_target),
        to_source_(to_source),
        sigmas_squared_(sigmas_squared),
        surface_(static_cast<std::size_t>(to_target.width()), kNoDepth),
        gaps_(to_target.width()) {}

  /// Finds the gaps of row `y`, then closes the gaps of the row before. So no gap grows from another. To be
  /// called for each row in turn.
  /// @param parts  of the row, in which its gaps are
  void advance(int y, const std::vector<cv::Range>& parts, GaussianDepth* target);

 private:
  struct Filling {
    int column;
    Estimate estimate;
  };

  void find(int y, const std::vector<cv::Range>& parts, const GaussianDepth& target);
  /// Keeps the gaps for which the source has a depth, or through which something shines. Most gaps have
  /// neither, so this loop has no branch.
  void keepKnown(const float* row);
  /// The new value of a gap on the surface at depth `surface`: a depth; no depth, if something shines
  /// through; or null for no change.
  std::optional<Estimate> examine(const cv::Point& pixel, float surface, int origin, float shining) const;

  const GaussianDepth& source_;
  const DepthWarp& to_target_;
  const DepthWarp& to_source_;
  float sigmas_squared_;
  std::vector<float> surface_;  ///< depth of the gap at each pixel of a row; NaN: no gap
  RowPoints gaps_;
  std::vector<Filling> found_, to_close_;
};

}  // namespace rgbd_sfm_fusion
