// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/velocity_change.h"

namespace rgbd_sfm_fusion {

void VelocityChange::observe(const Step& step) {
  constexpr double kGain = 0.1;  // a third of a second at 30 Hz: a hand changes what it does as fast
  if (step.isKnown() && last_.isKnown()) {
    const Vector6 change = step.during(1.0) - last_.during(1.0);
    const auto follow = [](double& mean, double square) {
      mean = mean > 0.0 ? mean + kGain * (square - mean) : square;
    };
    follow(moves_, change.head<3>().squaredNorm() / 3.0);
    follow(turns_, change.tail<3>().squaredNorm() / 3.0);
  }
  last_ = step;
}

Matrix6 VelocityChange::duringReadout(double readout_time, double readout_sigma) const {
  // With an increment of variance q per frame, a mean and the next one differ by 2/3 q, a velocity and the
  // mean before it by 1/3 q, and a velocity and the mean of both sides by 1/6 q.
  constexpr double kFrame = 1.0 / 2.0, kKeyframe = 1.0 / 4.0;
  Vector6 variances;
  variances << Eigen::Vector3d::Constant(moves_), Eigen::Vector3d::Constant(turns_);
  const Vector6 velocity = last_.during(1.0);
  Matrix6 covariance = readout_sigma * readout_sigma * velocity * velocity.transpose();
  covariance.diagonal() += (kFrame + kKeyframe) * readout_time * readout_time * variances;
  return covariance;
}

}  // namespace rgbd_sfm_fusion
