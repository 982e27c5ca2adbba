// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Brightness at full resolution, and at a half, a quarter … of it. Level 0 is the image itself. A rectified
/// image has a part that the camera has seen; outside of this part there is nothing to compare.
class ImagePyramid {
 public:
  ImagePyramid() = default;

  /// Reuses the memory of the image before.
  /// @param grey  must not change afterwards
  /// @param seen  part of the image; empty: all of it
  void build(const GreyImage& grey, int levels, cv::Rect seen = {});

  /// The image itself, which is not copied.
  const GreyImage& grey() const { return grey_; }
  int levels() const { return static_cast<int>(levels_.size()); }
  const cv::Mat_<float>& operator[](int level) const { return levels_[static_cast<std::size_t>(level)]; }
  const cv::Rect& seen(int level) const { return seen_[static_cast<std::size_t>(level)]; }

 private:
  GreyImage grey_;
  std::vector<cv::Mat_<float>> levels_;
  std::vector<cv::Rect> seen_;
  std::vector<float> row_;  // work space
};

/// [1 / px of the level] Standard deviation of a level's central differences, by row or column, if the image
/// itself has independent noise with a standard deviation of 1.
double gradientOfNoise(int level);

/// Cameras of a pyramid's levels.
std::vector<PinholeCamera> cameraPyramid(const PinholeCamera& camera, int levels);

}  // namespace rgbd_sfm_fusion
