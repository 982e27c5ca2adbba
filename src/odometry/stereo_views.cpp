// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/stereo_views.h"

namespace rgbd_sfm_fusion {
namespace {

// With the new keyframe itself, they are enough views. 0.3 MB each.
constexpr std::size_t kMaxViews = kEnoughViews - 1;

}  // namespace

void StereoViews::setKeyframe(const ImagePyramid& image, const ImagePose& pose) {
  views_.clear();
  add(image, pose, 0.0);
}

void StereoViews::add(const ImagePyramid& image, const ImagePose& pose, double reach) {
  if (!views_.empty()) {
    const SE3& T_first_last = views_.back().pose.T_first_image;
    if ((pose.T_first_image.translation() - T_first_last.translation()).norm() < reach / (kMaxViews - 1))
      return;
  }
  if (views_.size() == kMaxViews) views_.erase(views_.begin() + 1);  // the oldest but the keyframe
  views_.push_back({image.grey(), image.seen(0), pose});
}

std::vector<StereoView> StereoViews::from(const ImagePose& keyframe, double readout_time) const {
  std::vector<StereoView> result;
  for (auto view = views_.rbegin(); view != views_.rend(); ++view) {
    const Brightness brightness = view->pose.brightness.relativeTo(keyframe.brightness);
    const SE3 T_view_keyframe = view->pose.T_first_image.inverse() * keyframe.T_first_image;
    const Matrix6 Ad = T_view_keyframe.adjoint();
    // As if the errors of the two poses had nothing in common. They share some of the old keyframe's, so this
    // is the most that it can be.
    result.push_back({&view->image, view->seen, T_view_keyframe, brightness, readout_time,
                      view->pose.velocity, keyframe.velocity,
                      view->pose.covariance + Ad * keyframe.covariance * Ad.transpose()});
  }
  return result;
}

}  // namespace rgbd_sfm_fusion
