// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/shutter.h"

#include <cmath>
#include <optional>

namespace rgbd_sfm_fusion {

void Shutter::reset(const OdometryOptions& options) {
  is_learned_ = options.estimate_readout;
  set_time_ = static_cast<double>(options.readout_time);
  estimator_ = ReadoutEstimator(set_time_);
  velocity_change_ = VelocityChange();
}

void Shutter::setOptions(const OdometryOptions& options) {
  is_learned_ = options.estimate_readout;
  const auto time = static_cast<double>(options.readout_time);
  if (time == set_time_) return;
  set_time_ = time;
  estimator_ = ReadoutEstimator(time);
}

void Shutter::observe(const CalibrationEquations& equations, Stamp keyframe, double aligned_time,
                      double interval) {
  estimator_.observe(equations, keyframe, velocity_change_.variances(true, true), aligned_time, interval);
}

double Shutter::readoutTime() const {
  return is_learned_ ? estimator_.readoutTime() : set_time_;
}

double Shutter::readoutSigma() const {
  return is_learned_ ? estimator_.sigma() : 0.0;
}

Matrix6 Shutter::covariance(const AlignmentResult& aligned, const Step& step, double aligned_time,
                            const Step& keyframe_step) const {
  const auto velocity = [](const Step& to_image, const Matrix6& to_frame) {
    return to_image.isKnown() ? std::make_optional<Vector6>(to_frame * to_image.velocity()) : std::nullopt;
  };
  const double sigma = readoutSigma();
  const Matrix6 of_motion = velocity_change_.duringReadout(
      velocity(step, Matrix6::Identity()), velocity(keyframe_step, aligned.T_frame_keyframe.adjoint()),
      std::hypot(readoutTime(), sigma), std::hypot(readoutTime() - aligned_time, sigma));
  return aligned.by_readout * of_motion * aligned.by_readout.transpose();
}

}  // namespace rgbd_sfm_fusion
