// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/previous_keyframe.h"

#include "rgbd_sfm_fusion/fusion/reprojection.h"
#include "rgbd_sfm_fusion/multiversion.h"
#include "rgbd_sfm_fusion/sensor/lateral_variance.h"

namespace rgbd_sfm_fusion {
namespace {

/// Three rows of the keyframe's own depth. At the image's border, `up` or `down` is the middle row.
struct OwnRows {
  const float *up, *middle, *down, *variance;
};

/// A carried depth is used where the keyframe has no depth, and where no neighbour in the keyframe would hide
/// it.
RGBD_SFM_FUSION_MULTIVERSION
void completeRow(const OwnRows own, const float* carried_mean, const float* carried_variance, int width,
                 float* __restrict mean, float* __restrict variance) {
  for (const int x : {0, width - 1}) mean[x] = own.middle[x], variance[x] = own.variance[x];
  for (int x = 1; x < width - 1; ++x) {
    const float z = own.middle[x], carried = carried_mean[x];
    const float front = (1.0f - kStepRatio) * carried;
    const bool hidden = (own.middle[x - 1] < front) | (own.middle[x + 1] < front) | (own.up[x] < front) |
                        (own.down[x] < front);
    const bool empty = !(z > 0.0f);
    mean[x] = empty ? (hidden ? kNoDepth : carried) : z;
    variance[x] = empty ? (hidden ? kNoDepth : carried_variance[x]) : own.variance[x];
  }
}

}  // namespace

GaussianDepth PreviousKeyframe::complete(const TrackingResult& tracked,
                                         const std::shared_ptr<const KeyframeMap>& keyframe,
                                         const PinholeCamera& camera, const ReprojectionOptions& options) {
  const SE3 T_odom_keyframe = tracked.T_odom_frame * tracked.T_frame_keyframe;
  if (current_ && current_->stamp != keyframe->stamp) {
    carried_ =
        reproject(current_->depth, camera, T_odom_keyframe.inverse() * T_odom_current_, covariance_, options);
  }
  current_ = keyframe;
  T_odom_current_ = T_odom_keyframe;
  covariance_ = tracked.covariance;

  const GaussianDepth& own = keyframe->depth;
  if (carried_.mean.empty()) return own;
  completed_.mean.create(own.mean.size());
  completed_.variance.create(own.mean.size());
  const int last = own.mean.rows - 1;
  for (int y = 0; y <= last; ++y) {
    const OwnRows rows{own.mean[y > 0 ? y - 1 : y], own.mean[y], own.mean[y < last ? y + 1 : y],
                       own.variance[y]};
    completeRow(rows, carried_.mean[y], carried_.variance[y], own.mean.cols, completed_.mean[y],
                completed_.variance[y]);
  }
  return completed_;
}

void PreviousKeyframe::reset() {
  *this = PreviousKeyframe();
}

}  // namespace rgbd_sfm_fusion
