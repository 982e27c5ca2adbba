// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>

#include "rgbd_sfm_fusion/fusion/fusion_options.h"
#include "rgbd_sfm_fusion/fusion/overlap.h"
#include "rgbd_sfm_fusion/fusion/scale_estimator.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// What all SfM depths of a frame have wrong in common. Where SfM has the inverse depth ρ [1/unit], on the
/// ray through (x, y, 1), the sensor's metres are
///
///     ρ_sensor = ρ/α + b + c · (x, y)
///
/// α is SfM's scale; b and c are what an error of the stereo pairs' poses does, a turn taken for a move.
/// Where the sensor sees one distance only, α and b look alike there, and the covariance says what that
/// leaves open elsewhere. All of it is relative to the sensor: what that has wrong everywhere is no part of
/// it.
struct SfmState {
  double alpha = std::numeric_limits<double>::quiet_NaN();  ///< [m/unit] NaN before the first fit
  double offset = 0.0;                                      ///< [1/m] b
  Eigen::Vector2d tilt = Eigen::Vector2d::Zero();           ///< [1/m] c, per unit of x and of y
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();     ///< of (ln α, b, c)

  /// By what a disparity offset of the sensor moves (ln α, b, c), per 1/m. The overlap cannot tell it from
  /// b, nor, as far as b is known not to be, from α: so it is in neither's covariance.
  Eigen::Vector4d by_sensor_offset = Eigen::Vector4d::Zero();

  double overlap_inverse_depth = 0.0;  ///< [1/m] mean of what it was fitted to

  bool isKnown() const { return alpha > 0.0; }

  /// [1/m] of SfM's inverse depth [1/unit] on the ray through (x, y, 1).
  double inverseDepth(double sfm, double x, double y) const {
    return sfm / alpha + offset + tilt.x() * x + tilt.y() * y;
  }

  /// [1/m²] What the state does not know of an inverse depth there: J P Jᵀ, J = (-ρ/α, 1, x, y).
  /// @param sfm  [1/unit] ρ
  double variance(double sfm, double x, double y) const {
    const Eigen::Vector4d J(-sfm / alpha, 1.0, x, y);
    return J.dot(covariance * J);
  }

  /// [1] σ / Z by the state of SfM depth in the image's middle, twice as far as what it was fitted to.
  double sigmaTwiceAsFar() const;
};

/// What the overlap of one frame says of (1/α, b, c): the normal equations of linear least squares.
struct StateEvidence {
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  Eigen::Vector4d vector = Eigen::Vector4d::Zero();
  double inverse_depth = 0.0;   ///< [1/m] mean of what was fitted
  bool of_scale_alone = false;  ///< b and c are taken to be zero, as in the paper
};

/// Eq. 9 and 10 with b and c: from each tile of the image the mean over the pixels that agree with the
/// others, and among tiles a robust fit. Tiles scatter by what is smooth inside them, so that a tile counts
/// as one measurement however many pixels it has, and the sum as fewer, as far as adjacent tiles err alike.
/// @param fit  of the same overlap, not refused: where it starts; of another estimator than kWeightedRobust
/// all there is
/// @return none where no tile agrees with the fit that it started from
std::optional<StateEvidence> stateEvidence(const Overlap& overlap, const ScaleEstimate& fit,
                                           const ScaleOptions& options);

/// The state over time. A keyframe's errors are the same in all frames that see it: what they say of it is
/// averaged, and counts once. With the next keyframe, b and c start from what they were like before, as a
/// variance, and α has walked.
class SfmStateFilter {
 public:
  SfmStateFilter();

  /// @param evidence  none: this frame has no fit. α is held, and becomes less certain
  /// @param keyframe  stamp of the one that the frame's SfM depth is from
  SfmState update(const std::optional<StateEvidence>& evidence, Stamp keyframe, Stamp stamp,
                  const ScaleOptions& options);

  /// Time passes without SfM depth.
  SfmState hold(Stamp stamp, const ScaleOptions& options);

  /// As of the last update.
  const SfmState& state() const { return state_; }

 private:
  void startKeyframe(Stamp keyframe, const ScaleOptions& options);
  void add(const StateEvidence& evidence);
  SfmState solve() const;
  SfmState solve(double offset_variance, double tilt_variance) const;

  /// What keyframes before were like, on the average.
  struct Learned {
    double sum, count;
    double mean() const { return sum / count; }
    double with(double current) const { return (sum + current) / (count + 1.0); }
    void remember(double current);
  };

  SfmState state_;   // as of `now_`
  SfmState solved_;  // of this keyframe, as of the last fit
  Stamp now_ = kNoStamp, keyframe_ = kNoStamp;
  Stamp started_ = kNoStamp;                                 // with the keyframe
  Stamp informed_ = kNoStamp;                                // by the last fit
  double prior_inverse_alpha_ = 0.0, prior_variance_ = 0.0;  // of 1/α, for this keyframe; 0: there is none
  double prior_by_offset_ = 0.0;                             // by what a sensor's offset moves that mean
  Learned offsets_, tilts_;                                  // [1/m²] squares of b and of c
  StateEvidence sum_;                                        // of this keyframe's frames
  int frames_ = 0;                                           // that it is of
};

}  // namespace rgbd_sfm_fusion
