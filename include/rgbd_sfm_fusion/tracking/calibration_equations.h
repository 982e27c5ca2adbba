// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>

#include "rgbd_sfm_fusion/tracking/direct_alignment.h"

namespace rgbd_sfm_fusion {

/// Normal equations of an aligned frame, by all that its images may tell. H δ = g, where a residual r becomes
/// r + J δ.
struct CalibrationEquations {
  enum Parameter {
    kPose = 0,            ///< and the five after it: keyframe-side step, as direct alignment has it
    kGain = 6,            ///< of the brightness
    kOffset = 7,          ///< of the brightness
    kReadout = 8,         ///< readout time, as a share of the time since the last frame with a pose
    kPrincipalPoint = 9,  ///< [px of the full image] of frame and keyframe, in x; then in y
    kDepthTilt = 11,      ///< relative error of the keyframe's inverse depths, per ray in x; then in y
    kParameters = 13
  };
  using Matrix = Eigen::Matrix<double, kParameters, kParameters>;
  using Vector = Eigen::Matrix<double, kParameters, 1>;
  struct Part {
    Matrix H = Matrix::Zero();
    Vector g = Vector::Zero();
    double share = 0.0;  ///< ReadoutMotion::share() of the part's middle row in the keyframe
  };

  Matrix H = Matrix::Zero();
  Vector g = Vector::Zero();
  std::array<Part, NormalEquations::kStrips> strips;  ///< of the keyframe, from top to bottom
};

/// The equations at the alignment's result.
/// @param problem        the problem that `aligned` is the result of
/// @param keyframe_step  twist of the keyframe's motion in the time since the last frame with a pose
CalibrationEquations calibrationEquations(const AlignmentProblem& problem, const AlignmentResult& aligned,
                                          const Vector6& keyframe_step);

}  // namespace rgbd_sfm_fusion
