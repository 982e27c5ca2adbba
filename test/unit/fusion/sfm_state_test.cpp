// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/sfm_state.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>
#include <random>

#include "unit/fusion/overlaps.h"

namespace rgbd_sfm_fusion {
namespace {

using test::makeOverlap;
using test::OverlapErrors;

constexpr Stamp kFrame = 33'333'333;
constexpr double kAlpha = test::kOverlapAlpha;

StateEvidence evidence(const OverlapErrors& errors, std::uint64_t seed, const ScaleOptions& options = {}) {
  const Overlap overlap = makeOverlap(errors, seed);
  const ScaleEstimate fit = fitScale(overlap, options);
  EXPECT_FALSE(fit.refused);
  return stateEvidence(overlap, fit, options).value();
}

SfmState stateOf(const OverlapErrors& errors, std::uint64_t seed) {
  return SfmStateFilter().update(evidence(errors, seed), 0, 0, {});
}

TEST(SfmState, IsFoundThoughATenthOfThePixelsIsWild) {
  OverlapErrors errors;
  errors.tile = 0.003;
  errors.wild_share = 0.1;
  for (const double size : {-1.0, 0.0, 1.0}) {
    errors.offset = 0.01 * size;
    errors.tilt_x = -0.02 * size;
    errors.tilt_y = 0.015 * size;
    double squares = 0.0;
    constexpr int kRuns = 40;
    for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
      const SfmState state = stateOf(errors, seed);
      Eigen::Vector4d error(std::log(state.alpha / kAlpha), state.offset - errors.offset,
                            state.tilt.x() - errors.tilt_x, state.tilt.y() - errors.tilt_y);
      EXPECT_LT(std::abs(error(1)), 0.009);
      squares += error.dot(state.covariance.inverse() * error) / 4.0;
    }
    EXPECT_LT(squares / kRuns, 2.0) << size;
    EXPECT_GT(squares / kRuns, 0.3) << size;
  }
}

/// A wrong region must not be taken for b or c, even where its pixels err by less than three of their sigmas.
TEST(SfmState, IsFoundThoughTheSensorIsWrongInAQuarterOfTheImage) {
  OverlapErrors errors;
  errors.pixel = errors.stated = 0.04;
  errors.tile = 0.01;
  errors.nearest = 0.8;
  errors.farthest = 1.5;
  double squares = 0.0;
  constexpr int kRuns = 40;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    errors.false_columns = 0;
    const SfmState right = stateOf(errors, seed);
    errors.false_columns = 2;
    const SfmState state = stateOf(errors, seed);
    const double there = kAlpha;  // [1/unit] at 1 m, in the middle of what is wrong
    squares += std::pow(state.inverseDepth(there, -0.43, 0.0) - right.inverseDepth(there, -0.43, 0.0), 2);
  }
  EXPECT_LT(std::sqrt(squares / kRuns), 0.02);
}

/// Where the overlap spans little depth, α and b are nearly the same. At other depths they differ, and the
/// covariance must say so, however large b and c are in a run.
TEST(SfmState, KnowsWhatAShallowOverlapLeavesOpenElsewhere) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  OverlapErrors errors;
  errors.nearest = 1.0;
  errors.farthest = 1.3;
  errors.tile = 0.003;
  constexpr int kRuns = 40, kKeyframes = 10;
  for (const double size : {0.002, 0.01}) {
    double squares[3] = {}, sigma[3] = {};
    for (int run = 0; run < kRuns; ++run) {
      SfmStateFilter filter;
      SfmState state;
      for (int keyframe = 0; keyframe < kKeyframes; ++keyframe) {
        errors.alpha = kAlpha * std::exp(1.15 * size * normal(random));  // the baseline errs like the turn
        errors.offset = size * normal(random);
        errors.tilt_x = size * normal(random);
        errors.tilt_y = size * normal(random);
        state = filter.update(evidence(errors, static_cast<std::uint64_t>(kKeyframes * run + keyframe)),
                              30 * keyframe * kFrame, 30 * keyframe * kFrame, {});
      }
      EXPECT_GT(state.covariance(0, 1) / std::sqrt(state.covariance(0, 0) * state.covariance(1, 1)), 0.5);
      int i = 0;
      for (const double z : {1.15, 2.3, 4.6}) {
        const double sfm = (1.0 / z - errors.offset) * errors.alpha;
        const double error = state.inverseDepth(sfm, 0.0, 0.0) - 1.0 / z;
        squares[i] += error * error / state.variance(sfm, 0.0, 0.0) / kRuns;
        sigma[i++] += std::sqrt(state.variance(sfm, 0.0, 0.0)) * z / kRuns;
      }
    }
    for (int i = 0; i < 3; ++i) {
      // Less is known at the start of a run, and b is not believed beyond the overlap.
      EXPECT_GT(squares[i], 0.05) << size << " " << i;
      EXPECT_LT(squares[i], 2.0) << size << " " << i;
    }
    EXPECT_LT(sigma[0], 0.004) << "where they overlap";
    EXPECT_GT(sigma[2], size) << "four times as far";
  }
}

TEST(SfmStateFilter, KnowsNothingBeforeTheFirstFit) {
  SfmStateFilter filter;
  EXPECT_FALSE(filter.stateAt(0, {}).isKnown());
  EXPECT_FALSE(filter.update(std::nullopt, 0, 0, {}).isKnown());
  const SfmState first = filter.update(evidence({}, 1), 0, kFrame, {});
  EXPECT_NEAR(first.alpha, kAlpha, 0.05);
}

TEST(SfmStateFilter, CountsAKeyframeOnceHoweverManyFramesSeeIt) {
  SfmStateFilter filter;
  const StateEvidence same = evidence({}, 1);
  const SfmState first = filter.update(same, 0, 0, {});
  SfmState last;
  for (int n = 1; n < 300; ++n) last = filter.update(same, 0, n * kFrame, {});
  EXPECT_NEAR(last.alpha, first.alpha, 1e-9);
  EXPECT_TRUE(last.covariance.isApprox(first.covariance, 1e-9));
  // Keyframes with independent errors do add up, but α walks between them.
  for (int n = 300; n < 600; ++n) last = filter.update(evidence({}, 2), n / 10 * 10 * kFrame, n * kFrame, {});
  EXPECT_LT(last.covariance(0, 0), 0.7 * first.covariance(0, 0));
  EXPECT_GT(last.covariance(0, 0), 0.01 * first.covariance(0, 0));
}

TEST(SfmStateFilter, OffsetAndTiltAreAKeyframesOwn) {
  SfmStateFilter filter;
  OverlapErrors errors;
  errors.offset = 0.01;
  EXPECT_GT(filter.update(evidence(errors, 1), 0, 0, {}).offset, 0.005);
  const SfmState next = filter.update(std::nullopt, 30 * kFrame, 30 * kFrame, {});
  EXPECT_NEAR(next.alpha, kAlpha, 0.1);
  EXPECT_EQ(next.offset, 0.0);
  EXPECT_GT(next.covariance(1, 1), stateOf(errors, 1).covariance(1, 1));
}

/// The paper's estimators take b and c for zero. That says nothing of their size.
TEST(SfmStateFilter, LearnsNothingOfTheOffsetFromTheScaleAlone) {
  ScaleOptions of_paper;
  of_paper.estimator = ScaleEstimatorKind::kMeanRatio;
  OverlapErrors errors;
  SfmStateFilter filter;
  Stamp now = 0;
  for (int n = 0; n < 60; ++n, now += kFrame)
    filter.update(evidence(errors, 1, of_paper), now, now, of_paper);
  errors.offset = 0.01;
  for (int n = 0; n < 2; ++n, now += kFrame) filter.update(evidence(errors, 2), now, now, {});
  EXPECT_GT(filter.state().offset, 0.005);
}

/// A keyframe without a fit takes over the scale, which has walked since the keyframe before began.
TEST(SfmStateFilter, WalksOnceWithoutAFit) {
  ScaleOptions of_paper;
  of_paper.estimator = ScaleEstimatorKind::kMeanRatio;
  const StateEvidence same = evidence({}, 1, of_paper);
  const Stamp start = 0, last_fit = 150 * kFrame, later = 300 * kFrame;
  SfmStateFilter filter;
  const double fitted = filter.update(same, start, start, of_paper).covariance(0, 0);
  filter.update(same, start, last_fit, of_paper);
  const SfmState next = filter.update(std::nullopt, later, later, of_paper);
  const double walked = std::pow(of_paper.process_sigma, 2) * toSeconds(later - start);
  EXPECT_NEAR(next.covariance(0, 0) - fitted, walked, 0.1 * walked);
}

TEST(SfmStateFilter, LearnsTheOffsetApartFromTheTilt) {
  SfmStateFilter filter;
  OverlapErrors errors;
  for (int n = 0; n < 20; ++n) {
    errors.offset = n % 2 == 0 ? 0.02 : -0.02;
    filter.update(evidence(errors, static_cast<std::uint64_t>(n)), n * kFrame, n * kFrame, {});
  }
  const SfmState next = filter.update(std::nullopt, 20 * kFrame, 20 * kFrame, {});
  EXPECT_GT(std::sqrt(next.covariance(1, 1)), 0.01);
  EXPECT_LT(std::sqrt(next.covariance(2, 2)), 0.005);
}

/// An offset of the sensor looks like b, or like another α. The state says how far the offset moves SfM's
/// depth.
TEST(SfmState, SaysWhatASensorsOffsetDoesToIt) {
  OverlapErrors errors;
  errors.nearest = 1.0;
  errors.farthest = 1.5;
  const SfmState right = stateOf(errors, 3);
  errors.offset = 1e-5;  // of the sensor's inverse depths
  const SfmState wrong = stateOf(errors, 3);
  for (const double z : {1.2, 2.4, 4.8}) {
    const double sfm = kAlpha / z;
    const double change = (wrong.inverseDepth(sfm, 0.0, 0.0) - right.inverseDepth(sfm, 0.0, 0.0)) / 1e-5;
    const double gain = right.by_sensor_offset.dot(Eigen::Vector4d(-1.0 / z, 1.0, 0.0, 0.0));
    EXPECT_NEAR(gain, change, 0.15) << z;
    EXPECT_NEAR(gain, 1.0, z < 1.3 ? 0.1 : 10.0) << "in the overlap SfM takes it over";
  }
}

TEST(SfmStateFilter, HoldsTheScaleAndGrowsItsSigmaWithoutFit) {
  SfmStateFilter filter;
  const SfmState first = filter.update(evidence({}, 1), 0, 0, {});
  SfmState last = first;
  for (int n = 1; n <= 30; ++n) {
    const SfmState held =
        n % 2 == 0 ? filter.stateAt(n * kFrame, {}) : filter.update(std::nullopt, 0, n * kFrame, {});
    EXPECT_DOUBLE_EQ(held.alpha, first.alpha);
    EXPECT_GT(held.covariance(0, 0), last.covariance(0, 0));
    last = held;
  }
  const double walk = ScaleOptions().process_sigma;  // in a second
  EXPECT_NEAR(last.covariance(0, 0) - first.covariance(0, 0), walk * walk, 1e-6);
  EXPECT_EQ(filter.stateAt(0, {}).covariance(0, 0), last.covariance(0, 0))
      << "stamps that go back are no time";
}

TEST(SfmStateFilter, StartsAnewWithAnotherMap) {
  SfmStateFilter filter;
  for (int n = 0; n < 10; ++n) filter.update(evidence({}, 1), 0, n * kFrame, {});
  StateEvidence larger = evidence({}, 1);  // 1/α three times as large
  larger.vector = larger.information * Eigen::Vector4d(3.0 / kAlpha, 0.0, 0.0, 0.0);
  EXPECT_NEAR(filter.update(larger, 10 * kFrame, 10 * kFrame, {}).alpha, kAlpha / 3.0, 1e-6);
}

TEST(SfmStateFilter, KeepsTheScaleWhereAFrameLeavesANegativeOne) {
  SfmStateFilter filter;
  const SfmState first = filter.update(evidence({}, 1), 0, 0, {});
  StateEvidence negative = evidence({}, 1);
  negative.vector = negative.information * Eigen::Vector4d(-1.0 / kAlpha, 0.0, 0.0, 0.0);
  EXPECT_DOUBLE_EQ(filter.update(negative, 10 * kFrame, 10 * kFrame, {}).alpha, first.alpha);
}

TEST(StateEvidence, HasTheSizeOfTheField) {
  for (const double size : {0.01, 0.03}) {
    double sum = 0.0;
    constexpr int kRuns = 20;
    for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
      OverlapErrors errors;
      errors.tile = size;
      errors.pixel = 0.01;
      errors.wild_share = 0.1;
      sum += std::sqrt(evidence(errors, seed).field_variance) / kRuns;
    }
    EXPECT_NEAR(sum, size, 0.25 * size) << size;
  }
}

TEST(SfmStateFilter, DoesNotBelieveBeyondTheOverlapWhatTheOverlapSaysOfB) {
  SfmStateFilter filter;
  OverlapErrors errors;
  errors.offset = 0.02;
  errors.nearest = 1.0;
  errors.farthest = 2.0;
  SfmState state;
  for (int n = 0; n < 100; ++n)
    state = filter.update(evidence(errors, static_cast<std::uint64_t>(n)), n * kFrame, n * kFrame, {});
  const double there = state.alpha * state.overlap_inverse_depth;
  EXPECT_LT(std::sqrt(state.variance(there, 0.0, 0.0)), 0.005);
  EXPECT_GT(std::sqrt(state.variance(0.0, 0.0, 0.0)), 0.015) << "at infinity";
}

TEST(StateEvidence, OfAScaleThatIsExactIsFinite) {
  ScaleOptions options;
  options.estimator = ScaleEstimatorKind::kMeanRatio;
  ScaleEstimate exact;
  exact.alpha = kAlpha;
  exact.sigma = 0.0;
  const StateEvidence said = stateEvidence(makeOverlap({}, 1), exact, options).value();
  EXPECT_TRUE(said.information.allFinite());
  EXPECT_NEAR(SfmStateFilter().update(said, 0, 0, options).alpha, kAlpha, 1e-9);
}

TEST(SfmStateFilter, OfTheScaleAloneIsThePapers) {
  ScaleOptions options;
  options.estimator = ScaleEstimatorKind::kMeanRatio;
  options.filter = false;
  options.sigma_alpha = false;
  SfmStateFilter filter;
  for (std::uint64_t seed = 1; seed < 4; ++seed) {
    OverlapErrors errors;
    errors.offset = 0.02;
    const double alpha = fitScale(makeOverlap(errors, seed), options).alpha;
    const SfmState state = filter.update(evidence(errors, seed, options), 0, kFrame, options);
    EXPECT_NEAR(state.alpha, alpha, 1e-9);
    EXPECT_EQ(state.offset, 0.0);
    EXPECT_EQ(state.tilt.norm(), 0.0);
    EXPECT_EQ(state.covariance.norm(), 0.0);
    EXPECT_EQ(state.sigmaTwiceAsFar(FusionOptions::paper().noise), 0.0);
  }
}

/// Regions of the overlap are off, and so is the region twice as far. What the former do to the fit is in the
/// state's covariance: counting the field once more for it would make errors too small for what is stated.
TEST(SfmState, WhatIsStatedTwiceAsFarIsAsLargeAsErrorsThere) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  DepthNoiseModel noise;
  noise.common_scale_sigma = noise.common_offset_sigma = 0.0F;
  OverlapErrors errors;
  errors.tile = 0.015;
  double squares = 0.0;
  constexpr int kRuns = 100, kKeyframes = 10;
  for (int run = 0; run < kRuns; ++run) {
    SfmStateFilter filter;
    SfmState state;
    for (int keyframe = 0; keyframe < kKeyframes; ++keyframe)
      state = filter.update(evidence(errors, static_cast<std::uint64_t>(kKeyframes * run + keyframe)),
                            30 * keyframe * kFrame, 30 * keyframe * kFrame, {});
    const double there = 0.5 * state.overlap_inverse_depth;
    const double error = state.inverseDepth(kAlpha * there, 0.0, 0.0) - there + errors.tile * normal(random);
    squares += std::pow(error / there / state.sigmaTwiceAsFar(noise), 2) / kRuns;
  }
  EXPECT_GT(squares, 0.7);
  EXPECT_LT(squares, 1.4);
}

TEST(SfmState, WhatIsStatedTwiceAsFarContainsTheSensorsOwnErrors) {
  SfmState state;
  state.alpha = 2.0;
  state.overlap_inverse_depth = 1.0;  // twice as far: 2 m
  state.by_sensor_offset << 0.5, 1.5, 0.0, 0.0;
  DepthNoiseModel noise;
  noise.common_scale_sigma = 0.0F;
  noise.common_offset_sigma = 0.01F;
  // At 2 m, an offset of 0.01 / m changes SfM's inverse depth by 0.01 (1.5 - 0.5 / 2) / m.
  EXPECT_NEAR(state.sigmaTwiceAsFar(noise), 2.0 * 0.01 * 1.25, 1e-9);
  noise.common_scale_sigma = 0.03F;
  EXPECT_NEAR(state.sigmaTwiceAsFar(noise), std::hypot(0.03, 0.025), 1e-8);
  state.field_variance = 1e-4;
  EXPECT_NEAR(state.sigmaTwiceAsFar(noise), std::hypot(0.03, 0.025, 0.02), 1e-8);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
