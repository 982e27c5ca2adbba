// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/depth_delay_estimation.h"

namespace rgbd_sfm_fusion {

void DepthDelayEstimator::observe(const AlignmentResult& aligned, const Vector6& step, double interval,
                                  const Keyframe& keyframe) {
  if (aligned_with_.stamp == keyframe.stamp) aligned_with_.velocity = keyframe.velocity;  // better known now
  if (aligned_with_.stamp != kNoStamp) learn((step_ + step) / (interval_ + interval));
  aligned_ = aligned;
  aligned_with_ = keyframe;
  step_ = step;
  interval_ = interval;
}

void DepthDelayEstimator::learn(const Vector6& velocity) {
  using Scalar = CalibrationBelief<1>::Matrix;
  const Matrix6 to_keyframe = aligned_.T_frame_keyframe.inverse().adjoint();
  const Matrix6 covariance = to_keyframe * aligned_.covariance * to_keyframe.transpose();
  const Vector6 change = to_keyframe * velocity - aligned_with_.velocity;
  // With a delay d, depth asks for a pose that is the step d · change away. Information on d is what depth
  // has of it, less what the pose may take up.
  const Vector6 of_pose = aligned_.depth_information * change;
  const double information = change.dot(of_pose) - of_pose.dot(covariance * of_pose);
  const double measured = change.dot(aligned_.depth_pull) / information;
  belief_.observe(Scalar(information), Scalar(measured), aligned_with_.stamp, Scalar(aligned_with_.delay));
}

}  // namespace rgbd_sfm_fusion
