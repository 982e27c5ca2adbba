// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/tracking/calibration_equations.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Learns by how much the calibration's principal point is off (method.md 10), from the residuals of aligned
/// frames: a turn of the camera stretches and shears the image about the principal point, and a wrong one
/// leaves a stretch that no pose explains. A calibration is either right, or off by some pixels. Bayes' rule
/// tells which; until it is clear, the given one holds.
class PrincipalPointEstimator {
 public:
  explicit PrincipalPointEstimator(const PinholeCamera& camera);

  /// Learns from an aligned frame.
  /// @param keyframe    that it was aligned with. The frames of one keyframe share its errors, so that all of
  ///                    them together say no more than the one that says most
  /// @param correction  [px] of the principal point that it was aligned with
  /// @param readout_sigma  standard deviation of the readout time, as a share of the time since the last
  ///                       frame
  void observe(const CalibrationEquations& equations, Stamp keyframe, const Eigen::Vector2d& correction,
               double readout_sigma);

  /// [px] to add to the given principal point; 0 while there is no clear sign that it is off.
  Eigen::Vector2d correction() const;

  /// [px] Standard deviation of correction(), each way.
  Eigen::Vector2d sigma() const;

  /// Derivative of the last frame's keyframe-side step by an error of the principal point [1/px].
  const Eigen::Matrix<double, 6, 2>& stepByPrincipalPoint() const { return step_by_principal_point_; }

  /// [px²] What the images leave open, if the calibration is off.
  const Eigen::Matrix2d& covarianceIfOff() const { return belief_.covariance; }

 private:
  /// A sum of measurements m with the information J.
  struct Evidence {
    Eigen::Matrix2d information = Eigen::Matrix2d::Zero();  // Σ J
    Eigen::Vector2d pull = Eigen::Vector2d::Zero();         // Σ J m
    double square = 0.0;                                    // Σ m J m
    int count = 0;

    void add(const Eigen::Matrix2d& J, const Eigen::Vector2d& m);
    Eigen::Vector2d mean() const;
    /// Mean square of (m - mean) [σ²] each way, for at least two measurements.
    double scatter() const;
  };
  /// What all the frames say if the calibration is off: its correction, and how probable that is.
  struct Belief {
    Eigen::Vector2d mean;
    Eigen::Matrix2d covariance;
    double log_odds;  ///< of "off", against "right"
  };
  Evidence withLatest() const;
  Belief belief() const;

  double prior_information_;  // [1/px²] each way, if the calibration is off
  Evidence keyframes_;        // all but the latest one
  Evidence frames_;           // of the latest keyframe, each as if it were independent
  double most_ = 0.0;         // the largest information of one of them, summed over both ways
  Eigen::Vector2d correction_ = Eigen::Vector2d::Zero();  // [px] in force for the latest keyframe
  Stamp keyframe_ = kNoStamp;
  Belief belief_;  // of all keyframes
  Eigen::Matrix<double, 6, 2> step_by_principal_point_ = Eigen::Matrix<double, 6, 2>::Zero();
};

}  // namespace rgbd_sfm_fusion
