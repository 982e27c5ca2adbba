// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>

#include "rgbd_sfm_fusion/fusion/fusion_options.h"
#include "rgbd_sfm_fusion/fusion/learned_mean.h"
#include "rgbd_sfm_fusion/fusion/scale_estimator.h"
#include "rgbd_sfm_fusion/fusion/sfm_points.h"
#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/sensor/depth_noise.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// The error that all SfM depths of a frame share. Where SfM has the inverse depth ρ [1/unit] on the ray
/// through (x, y, 1), the sensor has the inverse depth [1/m]
///
///     ρ_sensor = ρ/α + b + c · (x, y)
///
/// α is SfM's scale. b and c come from errors in the poses of stereo pairs, when a turn was taken for a move.
/// Where the sensor sees one distance only, α and b look alike, and the covariance says how uncertain SfM is
/// at other distances. Besides, regions of the image have errors of their own: the residual field, which is
/// known by its size. The state is relative to the sensor: an error that the sensor has everywhere is no part
/// of the state.
struct SfmState {
  double alpha = std::numeric_limits<double>::quiet_NaN();  ///< [m/unit] NaN before the first fit
  double offset = 0.0;                                      ///< [1/m] b
  Eigen::Vector2d tilt = Eigen::Vector2d::Zero();           ///< [1/m] c, per unit of x and of y

  /// Of (ln α, b, c). What the overlap says of b is not all that is wrong outside the overlap: in holes of
  /// recorded depth, errors are 1.75 times as large (hallway, depth beyond 4 m). So b may be off by its usual
  /// size, with α such that both cancel in the overlap.
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();

  /// Change of (ln α, b, c) per 1/m of a disparity offset of the sensor. The overlap cannot tell such an
  /// offset from b. As far as b is known to be small, the overlap cannot tell the offset from a change of α.
  /// The covariance does not contain the offset, as the sensor's own depth has it, too: fuse() adds it to
  /// both (SensorOffsetGain).
  Eigen::Vector4d by_sensor_offset = Eigen::Vector4d::Zero();

  double overlap_inverse_depth = 0.0;  ///< [1/m] mean inverse depth of the overlap
  double field_variance = 0.0;  ///< [1/m²] size of the field, as learned: spread of the tiles' medians
                                ///< about α alone. It has b and c and the pixels' noise in it, and so is the
                                ///< most that the field can be

  bool isKnown() const { return alpha > 0.0; }

  /// [1/m] SfM's inverse depth `sfm` [1/unit], corrected, on the ray through (x, y, 1).
  double inverseDepth(double sfm, double x, double y) const {
    return sfm / alpha + offset + tilt.x() * x + tilt.y() * y;
  }

  /// [1/m²] Variance that (ln α, b, c) add to this inverse depth: J P Jᵀ, J = (-ρ/α, 1, x, y).
  /// @param sfm  [1/unit] ρ
  double variance(double sfm, double x, double y) const {
    const Eigen::Vector4d J(-sfm / alpha, 1.0, x, y);
    return J.dot(covariance * J);
  }

  /// [1] σ / Z of what all SfM depths of a frame have wrong in common, in the image's middle, twice as far as
  /// the overlap: the state's covariance, the field, and what the sensor has wrong in common.
  double sigmaTwiceAsFar(const DepthNoiseModel& sensor) const;
};

/// Turns the points' SfM depth into metres: N(Z = 1/ρ_sensor, Z⁴ (s σ_ρ²/α² + J P Jᵀ + σ_field²)). SfmState
/// defines ρ_sensor, J P Jᵀ and the field; s is `squared_spread`. A point has no depth (NaN) where σ/Z
/// exceeds `max_relative_sigma`.
/// @param points           tracker units
/// @param squared_spread   [1] of SfM's errors over what its variances state
void align(const SfmState& state, const PinholeCamera& camera, double max_relative_sigma,
           double squared_spread, SfmPoints* points);

/// What the overlap of one frame says of (1/α, b, c): the normal equations of linear least squares.
struct StateEvidence {
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  Eigen::Vector4d vector = Eigen::Vector4d::Zero();
  double inverse_depth = 0.0;   ///< [1/m] mean of the tiles that were fitted
  double field_variance = 0.0;  ///< [1/m²] of the tiles about α alone: b and c are in it as well
  bool of_scale_alone = false;  ///< b and c are taken to be zero, as in the paper
};

/// In place of Eq. 9 and 10: the same with b and c. Each tile of the image gives the mean over its pixels
/// near its own median, so a tile that is wrong as a whole stands out; then a robust fit goes through the
/// tiles. Pixels of a tile share smooth errors, so a tile counts as one measurement, however many pixels it
/// has. Adjacent tiles may err alike, so the sum counts for less.
/// @param fit  of the same overlap, not refused: the start. For estimators other than kWeightedRobust, `fit`
///             is all the evidence
/// @return     none if no tile agrees with the others
std::optional<StateEvidence> stateEvidence(const Overlap& overlap, const ScaleEstimate& fit,
                                           const ScaleOptions& options);

/// The state over time. A keyframe's errors are the same in all frames that see the keyframe: so the evidence
/// of these frames is averaged, and counts once. With the next keyframe, b and c start from zero, with the
/// variance that earlier keyframes showed. α starts from its last value, less certain by a random walk
/// and by what a wrong baseline of stereo does. Where 1/α jumps by more than 5 σ, the keyframe's evidence and
/// α's start are forgotten; what was learned of b and c stays.
class SfmStateFilter {
 public:
  SfmStateFilter();

  /// @param evidence  none: this frame has no fit. α is held, and becomes less certain
  /// @param keyframe  stamp of the keyframe that the frame's SfM depth is from
  SfmState update(const std::optional<StateEvidence>& evidence, Stamp keyframe, Stamp stamp,
                  const ScaleOptions& options);

  /// The state at a later time: α is held, and less certain.
  SfmState stateAt(Stamp stamp, const ScaleOptions& options);

  /// The state of the last update() or stateAt().
  const SfmState& state() const { return state_; }

 private:
  void startKeyframe(Stamp keyframe, const ScaleOptions& options);
  void add(const StateEvidence& evidence);
  SfmState solve() const;
  SfmState solve(double offset_variance, double tilt_variance) const;

  SfmState state_;   // as of `now_`
  SfmState solved_;  // of this keyframe, as of the last fit
  Stamp now_ = kNoStamp, keyframe_ = kNoStamp;
  Stamp started_ = kNoStamp;                                 // with the keyframe
  Stamp informed_ = kNoStamp;                                // by the last fit
  double prior_inverse_alpha_ = 0.0, prior_variance_ = 0.0;  // of 1/α, for this keyframe; 0: there is none
  double prior_by_offset_ = 0.0;                             // change of that mean per offset of the sensor
  LearnedMean offsets_, tilts_, fields_;                     // [1/m²] squares of b, of c, of the field
  StateEvidence sum_;                                        // of this keyframe's frames
  int frames_ = 0;                                           // that `sum_` contains
};

}  // namespace rgbd_sfm_fusion
