// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/direct_alignment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "rgbd_sfm_fusion/simd.h"
#include "rgbd_sfm_fusion/tracking/tracking_candidates.h"
#include "synthetic_views.h"

namespace rgbd_sfm_fusion {
namespace {

class DirectAlignment : public testing::Test {
 protected:
  DirectAlignment() {
    options_.pyramid_levels = 4;
    options_.finest_level = 0;
    candidates_.setKeyframe(pyramid(scene_.frame(0, SE3()).grey), cameraPyramid(scene_.camera(), 4), {2.0F});
    setDepth([](int, int) { return 1.0; });
  }

  /// @param factor          of the true inverse depth, by pixel
  /// @param relative_sigma  0: as good as exact
  void setDepth(const std::function<double(int, int)>& factor, double relative_sigma = 0.0) {
    InverseDepthImage depth;
    depth.create({scene_.camera().width, scene_.camera().height});
    for (int v = 0; v < scene_.camera().height; ++v) {
      for (int u = 0; u < scene_.camera().width; ++u) {
        const double truth = 1.0 / scene_.depth(SE3(), u, v), sigma = std::max(relative_sigma * truth, 1e-3);
        depth.mean(v, u) = static_cast<float>(factor(u, v) * truth);
        depth.variance(v, u) = static_cast<float>(sigma * sigma);
      }
    }
    candidates_.collect(depth, ReadoutMotion(), {}, {}, reference_);
  }

  ImagePyramid pyramid(const GreyImage& image) const {
    ImagePyramid result;
    result.build(image, options_.pyramid_levels);
    return result;
  }

  AlignmentResult alignFromIdentity(const GreyImage& image) const {
    return align({reference_, pyramid(image), options_, photometry_, {}, {}}, {SE3()});
  }

  PlaneScene scene_{smallCamera()};
  TrackingOptions options_;
  Photometry photometry_;
  TrackingCandidates candidates_;
  TrackingReference reference_;
};

const SE3 kMotions[] = {SE3(),
                        motion(0.03, 0, 0),
                        motion(0, -0.03, 0.01),
                        motion(0, 0, 0.08),
                        motion(0, 0, -0.08),
                        motion(0.02, 0.01, 0.02, 0.01, -0.02, 0.03),
                        motion(0, 0, 0, 0, 0, -0.06)};

TEST_F(DirectAlignment, FindsThePose) {
  for (const SE3& T : kMotions) {
    const AlignmentResult result = alignFromIdentity(scene_.frame(1, T).grey);
    EXPECT_TRUE(result.is_solvable);
    const Vector6 error = (result.T_frame_keyframe * T.inverse()).log();
    EXPECT_LT(error.head<3>().norm(), 6e-4) << T.log().transpose();
    EXPECT_LT(error.tail<3>().norm(), 3e-4) << T.log().transpose();
    EXPECT_GT(result.share_good, 0.99);
  }
}

/// A grown exposure makes white of a part of the image, where the keyframe has texture.
TEST_F(DirectAlignment, WhatIsTooBrightIsWhite) {
  for (const double gain : {1.4, 2.0}) {
    for (const SE3& T : kMotions) {
      GreyImage image;
      scene_.frame(1, T).grey.convertTo(image, CV_8U, gain);
      const AlignmentResult result = alignFromIdentity(image);
      EXPECT_LT((result.T_frame_keyframe * T.inverse()).log().norm(), 1e-3) << T.log().transpose();
      EXPECT_GT(result.share_good, 0.97) << T.log().transpose();
      EXPECT_NEAR(result.photometry.brightness.gain, gain, 0.02);
      EXPECT_GT(result.share_in_view, 0.85) << "white is in view";
    }
  }
}

/// With the exposure that came before, all points may be white.
TEST_F(DirectAlignment, WhiteFitsNothing) {
  photometry_.brightness = {2.4, 40.0};
  const GreyImage white(scene_.camera().height, scene_.camera().width, std::uint8_t{255});
  const AlignmentResult result = alignFromIdentity(white);
  EXPECT_FALSE(result.is_solvable && isPlausible(result.photometry.brightness) && result.share_good > 0.5) << result.share_in_view << " " << result.share_good;
}

/// A search that comes from far may end before it is there.
TEST_F(DirectAlignment, FromFarGoesOnFromWhereItEnds) {
  const SE3 T = motion(0.02, 0.01, 0.02, 0.01, -0.02, 0.03);
  const ImagePyramid image = pyramid(scene_.frame(1, T).grey);
  const std::vector<SE3> starts = {motion(0, 0, 0, 0.1, 0, 0), motion(0, 0, 0, 0, 0.1, 0.05)};
  const auto error = [&](const AlignmentResult& result) {
    return (result.T_frame_keyframe * T.inverse()).log().norm();
  };
  options_.max_iterations = 2;
  const AlignmentProblem problem{reference_, image, options_, photometry_, {}, {}};
  EXPECT_LT(error(alignFromFar(problem, starts)), 0.5 * error(align(problem, starts)));
}

TEST_F(DirectAlignment, CountsEachPointOnce) {
  const ImagePyramid image = pyramid(scene_.frame(1, SE3()).grey);
  for (int level = 0; level < 4; ++level) {
    const int count = reference_.points(level).count;
    ASSERT_NE(count % kLanes, 0) << "no padding, nothing to test";
    EXPECT_EQ(
        linearise({reference_, image, options_, photometry_, {}, {}}, level, SE3(), {0.0, 0.0, 0.0}).in_view,
        count);
  }
}

/// Far away, depth's variance would explain any difference of brightness.
TEST_F(DirectAlignment, PoorlyKnownDepthDoesNotLeadFarAway) {
  setDepth([](int u, int v) { return 1.0 + 0.2 * std::sin(0.11 * u * v); }, 0.3);
  for (const double turn : {0.02, 0.04, 0.06, 0.08, 0.1}) {
    for (const double sign : {-1.0, 1.0}) {
      const SE3 T = motion(0.003, -0.002, 0.001, sign * turn, 0.5 * turn, -turn);
      const AlignmentResult result = alignFromIdentity(scene_.frame(1, T, 2.0, 3).grey);
      const Vector6 error = (result.T_frame_keyframe * T.inverse()).log();
      EXPECT_LT(error.head<3>().norm(), 0.01) << T.log().transpose();
      EXPECT_LT(error.tail<3>().norm(), 0.005) << T.log().transpose();
    }
  }
}

/// At a wrong place, points whose depth is open fit all the same.
TEST_F(DirectAlignment, PointsOfUnknownDepthDoNotSpeakForAPlace) {
  const ImagePyramid image = pyramid(scene_.frame(1, motion(0.3, 0, 0)).grey);
  const SE3 wrong = motion(0.1, 0, 0);
  const auto shareGood = [&](int known_columns) {
    InverseDepthImage depth;
    depth.create({scene_.camera().width, scene_.camera().height});
    depth.mean.setTo(1.0 / scene_.depth(SE3(), 0, 0));
    depth.variance.setTo(100.0);
    depth.variance.colRange(0, known_columns).setTo(1e-6);
    candidates_.collect(depth, ReadoutMotion(), {}, {}, reference_);
    const NormalEquations equations =
        linearise({reference_, image, options_, photometry_, {}, {}}, 0, wrong, wrong.translation());
    return equations.good / equations.judged;
  };
  const double all_known = shareGood(scene_.camera().width);
  EXPECT_LT(all_known, 0.6);
  EXPECT_NEAR(shareGood(scene_.camera().width / 2), all_known, 0.1);
}

TEST_F(DirectAlignment, UnknownDepthIsNoNoiseOfTheImage) {
  const GreyImage image = scene_.frame(1, motion(0.05, 0.02, 0), 2.0).grey;
  const double noise = alignFromIdentity(image).photometry.noise;
  InverseDepthImage depth;
  depth.create({scene_.camera().width, scene_.camera().height});
  for (int v = 0; v < scene_.camera().height; ++v) {
    for (int u = 0; u < scene_.camera().width; ++u) {
      const bool is_known = u < scene_.camera().width / 2;
      depth.mean(v, u) = static_cast<float>((is_known ? 1.0 : 0.5) / scene_.depth(SE3(), u, v));
      depth.variance(v, u) = is_known ? 1e-6F : 100.0F;
    }
  }
  candidates_.collect(depth, ReadoutMotion(), {}, {}, reference_);
  EXPECT_NEAR(alignFromIdentity(image).photometry.noise, noise, 0.25 * noise);
}

TEST_F(DirectAlignment, FindsThePoseThroughAChangeOfBrightness) {
  const SE3 T = motion(0.02, 0.01, 0.02, 0.01, -0.02, 0.03);
  GreyImage dimmed;
  scene_.frame(1, T).grey.convertTo(dimmed, CV_8U, 0.8, 17.0);
  const AlignmentResult result = alignFromIdentity(dimmed);
  EXPECT_LT((result.T_frame_keyframe * T.inverse()).log().norm(), 1.5e-3);
  EXPECT_NEAR(result.photometry.brightness.gain, 0.8, 0.01);
  EXPECT_NEAR(result.photometry.brightness.offset, 17.0, 1.5);
}

TEST_F(DirectAlignment, IsNotLedAstrayByAFifthOfTheImage) {
  const SE3 T = motion(0.02, 0, 0.01, 0, 0.01, 0);
  GreyImage occluded = scene_.frame(1, T).grey;
  occluded(cv::Rect(40, 40, 140, 110)).setTo(90);
  const AlignmentResult result = alignFromIdentity(occluded);
  EXPECT_LT((result.T_frame_keyframe * T.inverse()).log().norm(), 3e-3);
  EXPECT_LT(result.share_good, 0.95);
}

TEST_F(DirectAlignment, CovarianceFitsTheErrorsOfNoisyImages) {
  const SE3 T = motion(0.02, 0.01, 0.02, 0.01, -0.02, 0.0);
  photometry_.noise = 5.0;
  double sum = 0.0;
  const int runs = 12;
  for (int run = 0; run < runs; ++run) {
    const AlignmentResult result =
        alignFromIdentity(scene_.frame(1, T, 7.0, static_cast<std::uint64_t>(run) + 1).grey);
    // The error of T_frame_keyframe is a perturbation on the left: T_true = exp(error) T_estimate.
    const Vector6 error = (T * result.T_frame_keyframe.inverse()).log();
    sum += error.dot(result.covariance.ldlt().solve(error)) / 6.0;
    EXPECT_LT(result.photometry.alike, 2.0);
  }
  EXPECT_GT(sum / runs, 0.3);
  EXPECT_LT(sum / runs, 4.0);
}

TEST_F(DirectAlignment, CovarianceCoversErrorsThatNeighboursShare) {
  const SE3 T = motion(0.08, 0.02, 0.02);
  photometry_.noise = 1.0;
  double sum = 0.0;
  const int runs = 8;
  for (int run = 0; run < runs; ++run) {
    setDepth(
        [run](int u, int v) { return 1.0 + 0.1 * std::sin(u / 25.0 + run) * std::cos(v / 20.0 + 2 * run); });
    const AlignmentResult result = alignFromIdentity(scene_.frame(1, T).grey);
    const Vector6 error = (T * result.T_frame_keyframe.inverse()).log();
    sum += error.dot(result.covariance.ldlt().solve(error)) / 6.0;
    EXPECT_GT(result.photometry.alike, 4.0);
  }
  EXPECT_GT(sum / runs, 0.2);
  EXPECT_LT(sum / runs, 15.0);
}

/// Thousands of points whose depths are wrong together fit a turn and a move that are wrong together. A few
/// hundred squares of sensor depth know better.
TEST_F(DirectAlignment, ErrorsThatNeighboursShareDoNotOutvoteSensorDepth) {
  const SE3 T = motion(0.08, 0.02, 0.02);
  const auto cells = [&](const SE3& T_camera_world) {
    DepthCells result;
    result.compute(scene_.depthImage(T_camera_world), scene_.camera(), DepthNoiseModel());
    return result;
  };
  const DepthCells at_keyframe = cells(SE3()), at_frame = cells(T);
  const DepthPair sensor{&at_keyframe, &at_frame, 0.0, 0.0, 0.002F};
  double squared = 0.0, squared_with_sensor = 0.0;
  for (int run = 0; run < 8; ++run) {
    setDepth(
        [run](int u, int v) { return 1.0 + 0.1 * std::sin(u / 25.0 + run) * std::cos(v / 20.0 + 2 * run); });
    const ImagePyramid image = pyramid(scene_.frame(1, T).grey);
    const auto error = [&](const DepthPair& depth) {
      const AlignmentResult result = align({reference_, image, options_, photometry_, {}, depth}, {SE3()});
      return (T * result.T_frame_keyframe.inverse()).log().squaredNorm();
    };
    squared += error({});
    squared_with_sensor += error(sensor);
  }
  EXPECT_LT(squared_with_sensor, 0.3 * squared);
}

/// Noise of the depth is in a residual and in its derivative alike. Most of a motion looks like a turn, and
/// the rest, which different depths tell, would be found a twelfth too short.
TEST_F(DirectAlignment, NoiseOfTheDepthLeavesTheMotionItsLength) {
  const SE3 T = motion(0.06, 0.0, 0.0);
  const double sigma = 0.05;
  const int runs = 6;
  photometry_.noise = M_SQRT2;  // of both images, while only one is noisy here
  double length = 0.0;
  for (int run = 0; run < runs; ++run) {
    cv::RNG random(static_cast<std::uint64_t>(run) + 1);
    setDepth([&](int, int) { return 1.0 + random.gaussian(sigma); }, sigma);
    length += alignFromIdentity(scene_.frame(1, T, 2.0, static_cast<std::uint64_t>(run) + 1).grey)
                  .T_frame_keyframe.translation()
                  .norm() /
              (runs * T.translation().norm());
  }
  EXPECT_NEAR(length, 1.0, 0.03);
}

TEST_F(DirectAlignment, TellsTheNoiseOfTheImage) {
  const SE3 T = motion(0.02, 0.01, 0.02, 0.01, -0.02, 0.0);
  for (const double noise : {2.0, 4.0, 8.0}) {
    photometry_.noise = 4.0;
    // The noise is estimated for keyframe and frame together, but only the frame is noisy here.
    for (int i = 0; i < 10; ++i)
      photometry_.noise = alignFromIdentity(scene_.frame(1, T, noise, 5).grey).photometry.noise;
    EXPECT_NEAR(photometry_.noise, noise * M_SQRT1_2, 0.3 * noise) << noise;
  }
}

TEST_F(DirectAlignment, GoesOnFromTheBestOfSeveralStarts) {
  const SE3 T = motion(0, 0, 0, 0.05, 0.6, 0);
  const GreyImage image = scene_.frame(1, T).grey;
  EXPECT_GT((alignFromIdentity(image).T_frame_keyframe * T.inverse()).log().norm(), 0.1);  // too far
  const std::vector<SE3> starts = {SE3(), motion(0, 0, 0, 0.04, 0.58, 0), motion(0.5, 0, 0)};
  const AlignmentResult result = align({reference_, pyramid(image), options_, photometry_, {}, {}}, starts);
  EXPECT_LT((result.T_frame_keyframe * T.inverse()).log().norm(), 1e-2);
}

/// A small image shows the shadows that move over the leaves, and not the leaves.
TEST_F(DirectAlignment, IsNotLedFromAGoodGuessBySmallImages) {
  const PinholeCamera& camera = scene_.camera();
  constexpr int kMove = 4, kMoveOfShadows = -20;  // [px]
  cv::Mat_<float> leaves(camera.height, camera.width + kMove);
  cv::RNG(1).fill(leaves, cv::RNG::NORMAL, 0.0, 100.0);
  cv::GaussianBlur(leaves, leaves, cv::Size(), 1.0);
  const auto image = [&](int move, int move_of_shadows) {
    GreyImage grey(camera.height, camera.width);
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        const double shadows = std::sin(0.1 * (u - move_of_shadows)) + std::sin(0.11 * v + 0.03 * u);
        grey(v, u) = cv::saturate_cast<std::uint8_t>(128.0 + 11.0 * shadows +
                                                     static_cast<double>(leaves(v, u + kMove - move)));
      }
    }
    return grey;
  };
  const double depth = 2.0;
  InverseDepthImage inverse_depth;
  inverse_depth.create({camera.width, camera.height});
  inverse_depth.mean.setTo(1.0 / depth);
  inverse_depth.variance.setTo(1e-6);
  candidates_.setKeyframe(pyramid(image(0, 0)), cameraPyramid(camera, 4), {2.0F});
  candidates_.collect(inverse_depth, ReadoutMotion(), {}, {}, reference_);
  const SE3 T = motion(kMove * depth / camera.fx, 0, 0), guess = motion(0.002, -0.002, 0) * T;
  for (const double gain : {1.0, 0.7}) {
    GreyImage dimmed;
    image(kMove, kMoveOfShadows).convertTo(dimmed, CV_8U, gain, 10.0);
    const AlignmentResult result =
        align({reference_, pyramid(dimmed), options_, photometry_, {}, {}}, {guess});
    EXPECT_LT((result.T_frame_keyframe * T.inverse()).log().norm(), 2e-3) << gain;
  }
}

/// Stripes look alike wherever the camera has moved by one of them, and a shadow fits the wrong one better.
/// Depth tells them apart.
TEST_F(DirectAlignment, TakesThePlaceWhereDepthFits) {
  const PinholeCamera& camera = scene_.camera();
  constexpr int kStripe = 64;  // [px]
  constexpr double kDepth = 2.0;
  const auto image = [&](int move, int move_of_shadow, double contrast) {
    GreyImage grey(camera.height, camera.width);
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        const double stripes = std::sin(2.0 * M_PI / kStripe * (u - move)) + std::sin(0.11 * v);
        const double shadow = std::sin(0.02 * (u - move_of_shadow));
        grey(v, u) = cv::saturate_cast<std::uint8_t>(128.0 + 50.0 * stripes + contrast * shadow);
      }
    }
    return grey;
  };
  const auto cells = [&](int move) {
    DepthImage depth(camera.height, camera.width, static_cast<float>(kDepth));
    for (int left = move; left < camera.width; left += 96)
      depth(cv::Rect(left, 0, std::min(48, camera.width - left), camera.height)).setTo(1.8);
    DepthCells result;
    result.compute(depth, camera, DepthNoiseModel());
    return result;
  };
  InverseDepthImage inverse_depth;
  inverse_depth.create({camera.width, camera.height});
  inverse_depth.mean.setTo(1.0 / kDepth);
  inverse_depth.variance.setTo(1e-6);
  candidates_.setKeyframe(pyramid(image(0, 0, 0.5)), cameraPyramid(camera, 4), {2.0F});
  candidates_.collect(inverse_depth, ReadoutMotion(), {}, {}, reference_);
  const auto moved = [&](int pixels) { return motion(pixels * kDepth / camera.fx, 0, 0); };
  const DepthCells keyframe = cells(0), frame = cells(16);
  const std::vector<SE3> starts = {moved(16 - kStripe), moved(16)};
  // A stronger shadow outvotes depth, unless it is known how many points share its error.
  for (const auto& [contrast, alike] : {std::pair(0.5, 1.0), std::pair(4.0, 20.0)}) {
    photometry_.alike = alike;
    const ImagePyramid now = pyramid(image(16, 16 - kStripe, contrast));
    const DepthPair depth{&keyframe, &frame, 0.0, 0.0, 0.005F};
    const AlignmentResult result = align({reference_, now, options_, photometry_, {}, depth}, starts);
    EXPECT_LT((result.T_frame_keyframe * moved(16).inverse()).log().norm(), 0.01) << contrast;
    EXPECT_GT(result.share_of_depth, 0.9) << contrast;
  }
}

TEST_F(DirectAlignment, KnowsWhatAMotionDuringTheReadoutIsTakenFor) {
  // The image was taken at once, but a motion during its readout is assumed: the pose makes up for it.
  const SE3 T = motion(0.02, 0.01, 0.02, 0.005, -0.01, 0.01);
  const ImagePyramid image = pyramid(scene_.frame(1, T).grey);
  const AlignmentResult right = align({reference_, image, options_, photometry_, {}, {}}, {T});
  for (int axis = 0; axis < 6; ++axis) {
    const Vector6 twist = (axis < 3 ? 0.02 : 0.01) * Vector6::Unit(axis);
    const FrameShutter shutter{SE3::exp(-twist) * T, 1.0};
    const AlignmentResult wrong = align({reference_, image, options_, photometry_, shutter, {}}, {T});
    const Vector6 taken_for = (wrong.T_frame_keyframe * right.T_frame_keyframe.inverse()).log();
    EXPECT_LT((taken_for + right.by_readout * twist).norm(), 0.4 * taken_for.norm() + 2e-4) << axis;
  }
  EXPECT_GT(right.by_readout.norm(), 0.1);
}

TEST_F(DirectAlignment, SaysWhenThereIsNothingToAlign) {
  EXPECT_FALSE(alignFromIdentity(scene_.frame(1, motion(0, 0, 0, 0, 3.0, 0)).grey).share_good > 0.6);
  InverseDepthImage none;
  none.create({scene_.camera().width, scene_.camera().height});
  none.clear();
  candidates_.collect(none, ReadoutMotion(), {}, {}, reference_);
  const AlignmentResult result = alignFromIdentity(scene_.frame(1, SE3()).grey);
  EXPECT_FALSE(result.is_solvable);
  EXPECT_TRUE(result.T_frame_keyframe.log().allFinite());
}

}  // namespace
}  // namespace rgbd_sfm_fusion
