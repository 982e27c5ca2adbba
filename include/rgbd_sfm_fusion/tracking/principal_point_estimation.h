// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/tracking/calibration_belief.h"
#include "rgbd_sfm_fusion/tracking/calibration_equations.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Learns by how much the calibration's principal point is off (method.md 10), from the residuals of aligned
/// frames: a turn of the camera stretches and shears the image about the principal point, and a wrong one
/// leaves a stretch that no pose explains.
class PrincipalPointEstimator {
 public:
  explicit PrincipalPointEstimator(const PinholeCamera& camera);

  /// Learns from an aligned frame.
  /// @param keyframe    that it was aligned with
  /// @param correction  [px] of the principal point that it was aligned with
  /// @param readout_sigma  standard deviation of the readout time, as a share of the time since the last
  ///                       frame
  void observe(const CalibrationEquations& equations, Stamp keyframe, const Eigen::Vector2d& correction,
               double readout_sigma);

  /// [px, px²] What the images say of the principal point, x and y.
  const CalibrationBelief<2>& belief() const { return belief_; }

  /// Derivative of the last frame's keyframe-side step by an error of the principal point [1/px].
  const Eigen::Matrix<double, 6, 2>& stepByPrincipalPoint() const { return step_by_principal_point_; }

 private:
  CalibrationBelief<2> belief_;
  Eigen::Matrix<double, 6, 2> step_by_principal_point_ = Eigen::Matrix<double, 6, 2>::Zero();
};

}  // namespace rgbd_sfm_fusion
