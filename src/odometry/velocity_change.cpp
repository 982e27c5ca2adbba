// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/velocity_change.h"

namespace rgbd_sfm_fusion {

void VelocityChange::MeanSquares::follow(const Vector6& sample) {
  constexpr double kGain = 0.1;  // a third of a second at 30 Hz: a hand changes its motion as fast
  const auto follow = [](double& mean, double square) {
    mean = mean > 0.0 ? mean + kGain * (square - mean) : square;
  };
  follow(moves, sample.head<3>().squaredNorm() / 3.0);
  follow(turns, sample.tail<3>().squaredNorm() / 3.0);
}

Vector6 VelocityChange::MeanSquares::perAxis() const {
  Vector6 variances;
  variances << Eigen::Vector3d::Constant(moves), Eigen::Vector3d::Constant(turns);
  return variances;
}

void VelocityChange::observe(const Step& step) {
  if (step.isKnown()) velocity_.follow(step.velocity());
  if (step.isKnown() && last_.isKnown()) change_.follow(step.velocity() - last_.velocity());
  last_ = step;
}

Vector6 VelocityChange::variances(bool of_frame, bool of_keyframe) const {
  // If velocity changes with variance q per frame, variances are these: 2/3 q between a frame interval's mean
  // and the next mean, 1/3 q between a velocity and the mean before it, and 1/6 q between a velocity and the
  // mean of both sides.
  const Vector6 unknown = velocity_.perAxis(), q = 3.0 / 2.0 * change_.perAxis();
  return (of_frame ? Vector6(q / 3.0) : unknown) + (of_keyframe ? Vector6(q / 6.0) : unknown);
}

Matrix6 VelocityChange::duringReadout(const std::optional<Vector6>& of_frame,
                                      const std::optional<Vector6>& of_keyframe, double readout_time,
                                      double readout_error) const {
  const Vector6 velocity = of_frame.value_or(Vector6::Zero()) - of_keyframe.value_or(Vector6::Zero());
  Matrix6 covariance = readout_error * readout_error * velocity * velocity.transpose();
  covariance.diagonal() +=
      readout_time * readout_time * variances(of_frame.has_value(), of_keyframe.has_value());
  return covariance;
}

}  // namespace rgbd_sfm_fusion
