// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/depth_delay_estimation.h"

namespace rgbd_sfm_fusion {

void DepthDelayEstimator::observe(const AlignmentResult& aligned, const Vector6& velocity,
                                  const Keyframe& keyframe) {
  if (last_.stamp != kNoStamp) learn(0.5 * (velocity_ + velocity));
  aligned_ = aligned;
  velocity_ = velocity;
  last_ = keyframe;
}

void DepthDelayEstimator::learn(const Vector6& velocity) {
  using Scalar = CalibrationBelief<1>::Matrix;
  const Matrix6 to_keyframe = aligned_.T_frame_keyframe.inverse().adjoint();
  const Matrix6 covariance = to_keyframe * aligned_.covariance * to_keyframe.transpose();
  const Vector6 change = to_keyframe * velocity - last_.velocity;
  // With a delay d, depth asks for a pose that is the step d · change away. Information on d is what depth
  // has of it, less what the pose may take up.
  const Vector6 of_pose = aligned_.depth_information * change;
  const double information = change.dot(of_pose) - of_pose.dot(covariance * of_pose);
  const double measured = change.dot(aligned_.depth_pull) / information;
  belief_.observe(Scalar(information), Scalar(measured), last_.stamp, Scalar(last_.delay));
}

}  // namespace rgbd_sfm_fusion
