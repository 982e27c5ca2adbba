// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/stereo_views.h"

namespace rgbd_sfm_fusion {

void StereoViews::setKeyframe(const ImagePyramid& image, const ImagePose& pose) {
  views_.clear();
  add(image, pose, 0.0);
}

void StereoViews::add(const ImagePyramid& image, const ImagePose& pose, double reach) {
  if (!views_.empty()) {
    const SE3& T_first_last = views_.back().pose.T_first_image;
    if ((pose.T_first_image.translation() - T_first_last.translation()).norm() < reach / (kEnoughViews - 1))
      return;
  }
  if (views_.size() == kEnoughViews) views_.erase(views_.begin() + 1);  // the oldest but the keyframe
  views_.push_back({image.grey(), image.seen(0), pose});
}

std::vector<StereoView> StereoViews::from(const ImagePose& keyframe, double readout_time) const {
  std::vector<StereoView> result;
  for (auto view = views_.rbegin(); view != views_.rend(); ++view) {
    const Brightness brightness = view->pose.brightness.relativeTo(keyframe.brightness);
    result.push_back({&view->image, view->seen, view->pose.T_first_image.inverse() * keyframe.T_first_image,
                      brightness, readout_time, view->pose.velocity, keyframe.velocity});
  }
  return result;
}

}  // namespace rgbd_sfm_fusion
