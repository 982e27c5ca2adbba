// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/mapping/inverse_depth.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// The depth that frames are aligned with, which is not the one that is published: the keyframe's stereo,
/// its sensor depth (with feedback, or of the first frame), and what the keyframe before knew where it has
/// neither (method.md 8, 9).
class TrackingDepth {
 public:
  explicit TrackingDepth(const PinholeCamera& camera);

  void clear();

  /// Sensor depth of the keyframe becomes the base of what is known; where it has none, what was carried
  /// over stays.
  /// @param depth  H x W, in tracker units
  void setSensor(const GaussianDepth& depth);

  /// Random depth becomes the base, with a mean inverse depth of 1: the start without a sensor (method.md 8).
  void setRandom();

  /// Carries all that is known to a new keyframe, less certain than before.
  /// @param warp  from the old keyframe to the new one
  void moveTo(const InverseDepthWarp& warp);

  /// Sets all that is known aside: no longer used itself, it can still contest sensor depth, since it rests
  /// on that of the keyframes before, but for what stereo contested there.
  void setAside();

  /// Drops sensor depth of this keyframe that what was set aside contests.
  /// @param parallax  as contestedCells() takes it
  void contestBySetAside(double parallax);

  /// Adds the keyframe's stereo to the base, from which contested sensor depth is dropped for good.
  /// @param parallax  as contestedCells() takes it
  /// @return the fused inverse depth; valid until the next call
  const InverseDepthImage& fuse(const InverseDepthImage& stereo, double parallax);

 private:
  void dropContested(const InverseDepthImage& other, double parallax);

  PinholeCamera camera_;
  InverseDepthImage base_, fused_, aside_;
  cv::Mat_<float> shared_;   // [1] relative variance that a pixel's depth shares with others
  bool has_sensor_ = false;  // of this keyframe
};

}  // namespace rgbd_sfm_fusion
