// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/sfm_state.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

// A stereo pair with baseline t may take a turn δ for a move. The errors of inverse depth are then about δ/t.
// They are 0.0005 / m in a rendered room (scripts/fit_fusion), and a hundred times larger under a rolling
// shutter: so kPoseSigma is only where learning starts. b is learned apart from c. A turn that looks like a
// move across the image is recognised worst (the bas-relief ambiguity). A roll makes a tilt, and is
// recognised well. What a pair's pose leaves wrong by region is of the same size.
constexpr double kPoseSigma = 0.005;  // [1/m] of b, of c and of the field, before a run has shown any

/// @param offset_variance, tilt_variance  [1/m²] of b and of c
Eigen::Matrix4d priorOfPoses(double offset_variance, double tilt_variance) {
  return Eigen::Vector4d(0.0, 1.0 / offset_variance, 1.0 / tilt_variance, 1.0 / tilt_variance).asDiagonal();
}

double meanSquareOfOffset(const SfmState& state) {
  return state.offset * state.offset + state.covariance(1, 1);
}

double meanSquareOfTilt(const SfmState& state) {
  return (state.tilt.squaredNorm() + state.covariance.diagonal().tail<2>().sum()) / 2.0;
}

StateEvidence nothing(bool of_scale_alone) {
  StateEvidence evidence;
  evidence.of_scale_alone = of_scale_alone;
  return evidence;
}

/// [unit²/m²] Variance that 1/α gains from `start` to `end`.
double walk(const SfmState& state, Stamp start, Stamp end, const ScaleOptions& options) {
  const double sigma = options.process_sigma / state.alpha;
  return sigma * sigma * std::max(toSeconds(end - start), 0.0);
}

/// A state on one row of the image. `_x` and `_xx` are coefficients of x and x², with x the sideways slope of
/// the ray.
struct RowState {
  float alpha, variance_scale;              // variance_scale: of SfM's own variance
  float shift, shift_x;                     // [1/m] b + c · (x, y)
  float relative;                           // [1] variance of ln α
  float mixed, mixed_x;                     // [1/m] -2 Cov(ln α, shift)
  float absolute, absolute_x, absolute_xx;  // [1/m²] variance of the shift
  float field;                              // [1/m²] variance of the residual field
  float max_relative;                       // [1] largest variance over Z² of depth that is used
};

RowState rowState(const SfmState& state, double max_relative_sigma, double squared_spread, double y) {
  const Eigen::Matrix4d& P = state.covariance;
  const auto number = [](double value) { return static_cast<float>(value); };
  return {number(state.alpha),
          number(state.alpha) * number(state.alpha) * number(squared_spread),
          number(state.offset + state.tilt.y() * y),
          number(state.tilt.x()),
          number(P(0, 0)),
          number(-2.0 * (P(0, 1) + P(0, 3) * y)),
          number(-2.0 * P(0, 2)),
          number(P(1, 1) + 2.0 * P(1, 3) * y + P(3, 3) * y * y),
          number(2.0 * (P(1, 2) + P(2, 3) * y)),
          number(P(2, 2)),
          number(state.field_variance),
          number(max_relative_sigma * max_relative_sigma)};
}

RGBD_SFM_FUSION_MULTIVERSION
void alignRow(const RowState s, const int* columns, int count, float x_first, float x_step,
              float* __restrict mean, float* __restrict variance) {
  for (int i = 0; i < count; ++i) {
    const float x = x_first + x_step * static_cast<float>(columns[i]);
    const float scaled = s.alpha * mean[i];
    const float change = 1.0f + scaled * (s.shift + s.shift_x * x);
    const float gain = 1.0f / change, z = scaled * gain, gain_squared = gain * gain, squared = z * z;
    const float by_state = gain_squared * s.relative + gain * z * (s.mixed + s.mixed_x * x) +
                           squared * (s.absolute + x * (s.absolute_x + x * s.absolute_xx));
    const float v = s.variance_scale * variance[i] * gain_squared * gain_squared +
                    squared * ((by_state > 0.0f ? by_state : 0.0f) + s.field * squared);
    const bool usable = (change > 0.0f) & (z > 0.0f) & (v > 0.0f) & (v <= s.max_relative * squared);
    mean[i] = usable ? z : kNoDepth;
    variance[i] = usable ? v : kNoDepth;
  }
}

}  // namespace

SfmStateFilter::SfmStateFilter()
    : offsets_{kPoseSigma * kPoseSigma, 1.0}, tilts_(offsets_), fields_(offsets_) {}

double SfmState::sigmaTwiceAsFar(const DepthNoiseModel& sensor) const {
  // Where α is all that is fitted, σ / Z is the same at any distance.
  const double inverse_depth = overlap_inverse_depth > 0.0 ? 0.5 * overlap_inverse_depth : 1.0;
  const double of_scale = static_cast<double>(sensor.common_scale_sigma);
  const double of_offset = static_cast<double>(sensor.common_offset_sigma) *
                           (by_sensor_offset(1) / inverse_depth - by_sensor_offset(0));
  const double of_state = variance(alpha * inverse_depth, 0.0, 0.0) + field_variance;
  return std::sqrt(of_state / (inverse_depth * inverse_depth) + of_scale * of_scale + of_offset * of_offset);
}

void align(const SfmState& state, const PinholeCamera& camera, double max_relative_sigma,
           double squared_spread, SfmPoints* points) {
  for (int y = 0; y < camera.height; ++y) {
    const RowState row = rowState(state, max_relative_sigma, squared_spread, (y - camera.cy) / camera.fy);
    const std::size_t first = points->begin(y);
    alignRow(row, points->columns.data() + first, static_cast<int>(points->end(y) - first),
             static_cast<float>(-camera.cx / camera.fx), static_cast<float>(1.0 / camera.fx),
             points->sfm.data() + first, points->sfm_variance.data() + first);
  }
}

void SfmStateFilter::startKeyframe(Stamp keyframe, const ScaleOptions& options) {
  prior_variance_ = 0.0;
  if (solved_.isKnown() && options.filter) {
    const double of_inverse = solved_.covariance(0, 0) / (solved_.alpha * solved_.alpha);
    prior_inverse_alpha_ = 1.0 / solved_.alpha;
    // A wrong baseline makes all depths of a keyframe wrong alike. In the overlap, this is as large as the
    // effect of b.
    const double sfm_inverse_depth = solved_.overlap_inverse_depth * solved_.alpha;
    prior_variance_ = of_inverse + walk(solved_, started_, now_, options) +
                      (sum_.of_scale_alone ? 0.0 : offsets_.mean() / (sfm_inverse_depth * sfm_inverse_depth));
    prior_by_offset_ = -solved_.by_sensor_offset(0) / solved_.alpha;  // of 1/α
    if (frames_ > 0 && !sum_.of_scale_alone) {
      offsets_.remember(meanSquareOfOffset(solved_));
      tilts_.remember(meanSquareOfTilt(solved_));
    }
  }
  keyframe_ = keyframe;
  started_ = now_;
  sum_ = nothing(sum_.of_scale_alone);
  frames_ = 0;
}

void SfmStateFilter::add(const StateEvidence& evidence) {
  const Eigen::Matrix4d alone =
      (evidence.information + priorOfPoses(offsets_.mean(), tilts_.mean())).inverse();
  const double inverse_alpha = (alone * evidence.vector)(0);
  const double innovation = inverse_alpha - 1.0 / state_.alpha;
  const double expected = alone(0, 0) + state_.covariance(0, 0) / (state_.alpha * state_.alpha);
  if (innovation * innovation > Overlap::kOutlierSquare * expected) {  // it is another map: α starts anew
    prior_variance_ = 0.0;
    sum_ = nothing(evidence.of_scale_alone);
    frames_ = 0;
  }
  if (evidence.of_scale_alone != sum_.of_scale_alone) {  // another estimator: its sums are of other things
    sum_ = nothing(evidence.of_scale_alone);
    frames_ = 0;
  }
  sum_.information += evidence.information;
  sum_.vector += evidence.vector;
  sum_.inverse_depth += evidence.inverse_depth;
  if (!evidence.of_scale_alone) fields_.remember(evidence.field_variance);
  ++frames_;
}

/// The posterior of (1/α, b, c), as a state.
SfmState SfmStateFilter::solve(double offset_variance, double tilt_variance) const {
  const double frames = std::max(frames_, 1);
  Eigen::Matrix4d information = sum_.information / frames + priorOfPoses(offset_variance, tilt_variance);
  Eigen::Vector4d vector = sum_.vector / frames, by_offset = sum_.information.col(1) / frames;
  if (prior_variance_ > 0.0) {
    information(0, 0) += 1.0 / prior_variance_;
    vector(0) += prior_inverse_alpha_ / prior_variance_;
    by_offset(0) += prior_by_offset_ / prior_variance_;
  }
  const Eigen::Matrix4d covariance = information.inverse();
  const Eigen::Vector4d solution = covariance * vector;
  SfmState state = solved_;
  state.alpha = 1.0 / solution(0);
  state.offset = solution(1);
  state.tilt = solution.tail<2>();
  const Eigen::Vector4d to_logarithm(-state.alpha, 1.0, 1.0, 1.0);
  state.covariance = to_logarithm.asDiagonal() * covariance * to_logarithm.asDiagonal();
  state.by_sensor_offset = to_logarithm.asDiagonal() * covariance * by_offset;
  if (frames_ > 0) state.overlap_inverse_depth = sum_.inverse_depth / frames;
  if (!sum_.of_scale_alone) return state;
  state.offset = 0.0;
  state.tilt.setZero();
  state.covariance.bottomRows<3>().setZero();
  state.covariance.rightCols<3>().setZero();
  state.by_sensor_offset.tail<3>().setZero();
  return state;
}

/// The priors of b and c follow their size in this keyframe and in earlier ones (expectation and maximisation
/// in turn).
SfmState SfmStateFilter::solve() const {
  SfmState state = solve(offsets_.mean(), tilts_.mean());
  for (int iteration = 0; iteration < Overlap::kRounds && frames_ > 0 && !sum_.of_scale_alone; ++iteration)
    state = solve(offsets_.with(meanSquareOfOffset(state)), tilts_.with(meanSquareOfTilt(state)));
  return state;
}

SfmState SfmStateFilter::update(const std::optional<StateEvidence>& evidence, Stamp keyframe, Stamp stamp,
                                const ScaleOptions& options) {
  now_ = std::max(now_, stamp);
  if (keyframe != keyframe_ || !options.filter) startKeyframe(keyframe, options);
  if (evidence) add(*evidence);
  if (frames_ > 0 || prior_variance_ > 0.0) {
    // If b alone explains a shallow overlap, any α fits. No new state is better than one with a negative α.
    if (const SfmState solved = solve(); solved.isKnown()) {
      solved_ = solved;
      if (evidence) informed_ = now_;
      if (frames_ == 0) informed_ = started_;  // until then, the walk is in the prior
    }
  }
  return stateAt(stamp, options);
}

SfmState SfmStateFilter::stateAt(Stamp stamp, const ScaleOptions& options) {
  now_ = std::max(now_, stamp);
  state_ = solved_;
  if (!state_.isKnown()) return state_;
  state_.covariance(0, 0) += state_.alpha * state_.alpha * walk(state_, informed_, now_, options);
  if (!sum_.of_scale_alone && state_.overlap_inverse_depth > 0.0) {
    const Eigen::Vector4d no_change_in_overlap(1.0 / state_.overlap_inverse_depth, 1.0, 0.0, 0.0);
    state_.covariance +=
        offsets_.with(meanSquareOfOffset(solved_)) * no_change_in_overlap * no_change_in_overlap.transpose();
    state_.field_variance = fields_.mean();
  }
  if (!options.sigma_alpha) {
    state_.covariance.setZero();
    state_.field_variance = 0.0;
  }
  return state_;
}

}  // namespace rgbd_sfm_fusion
