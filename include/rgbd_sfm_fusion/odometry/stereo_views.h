// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/image/brightness.h"
#include "rgbd_sfm_fusion/image/image_pyramid.h"
#include "rgbd_sfm_fusion/mapping/epipolar_stereo.h"
#include "rgbd_sfm_fusion/odometry/keyframe.h"

namespace rgbd_sfm_fusion {

/// Where an image was taken, and how.
struct ImagePose {
  SE3 T_first_image;
  Vector6 velocity = Vector6::Zero();    ///< [1/s] twist of the camera
  Brightness brightness;                 ///< relative to the keyframe
  Matrix6 covariance = Matrix6::Zero();  ///< of T_image_keyframe: left perturbation
};

/// The keyframe and images of its scene from other places, one fewer than kEnoughViews. A new keyframe uses
/// these images for stereo of the parts of its scene that are new. Without them, new parts would have to wait
/// for two more frames, which is long if frames are far apart.
class StereoViews {
 public:
  /// Starts anew.
  void setKeyframe(const ImagePyramid& image, const ImagePose& pose);

  /// Sets the keyframe's velocity, which is known with the first frame after it.
  void setKeyframeVelocity(const Vector6& velocity) { views_.front().pose.velocity = velocity; }

  /// Adds an image, unless it is so near to the last one that those that are kept would end before `reach`.
  /// @param reach  [tracker units] distance from the keyframe at which the next one starts
  void add(const ImagePyramid& image, const ImagePose& pose, double reach);

  /// The images as views of a new keyframe, from near to far: after a far view, a nearer one has nothing to
  /// add.
  /// @param keyframe  the new keyframe, with its brightness relative to the old one
  /// @return  views whose images are valid until the next call of setKeyframe() or add()
  std::vector<StereoView> from(const ImagePose& keyframe, double readout_time) const;

 private:
  struct View {
    GreyImage image;
    cv::Rect seen;
    ImagePose pose;
  };
  std::vector<View> views_;  // the keyframe first
};

}  // namespace rgbd_sfm_fusion
