// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How fusion treats the sensor's depth before fusing it: time, holes and steps.
#include <cmath>

#include "rgbd_sfm_fusion/sensor/lateral_variance.h"
#include "unit/fusion/fusion_sequence.h"

namespace rgbd_sfm_fusion {
namespace {

using test::expectConsistent;
using test::kFrame;
using test::kNone;
using test::options;
using test::Sequence;

/// Depth in patches, each of another surface: too small for a mirror, and too large for strays.
void makeWrong(DepthImage& depth) {
  cv::RNG random(1);
  for (int y = 0; y < depth.rows; y += 3) {
    for (int x = 0; x < depth.cols; x += 3) {
      const cv::Rect patch = cv::Rect(x, y, 3, 3) & cv::Rect({}, depth.size());
      depth(patch) *= random.uniform(1.0, 2.5);
    }
  }
}

TEST(DepthFusionSensor, CompensatesSkewByTheTrackedMotion) {
  const Sequence sequence(2.0);  // poses are in units of two metres
  struct {
    bool compensate, is_stamped;
  } constexpr kCases[] = {{false, true}, {true, true}, {true, false}};
  for (const auto& [compensate, is_stamped] : kCases) {
    FusionOptions chosen = options();
    chosen.compensate_skew = compensate;
    DepthFusion fusion(sequence.camera(), chosen);
    double error = 0.0;
    for (int n = 0; n < 6; ++n) {
      RgbdFrame frame = sequence.frame(n);
      frame.depth = sequence.trueDepth(Sequence::pose(n - 1));  // a frame late
      frame.depth_stamp = (is_stamped ? n - 1 : n) * kFrame;
      TrackingResult tracked = sequence.tracked(n);
      tracked.depth_delay = is_stamped ? 0.0 : toSeconds(kFrame);
      const FusedFrame fused = fusion.fuse(tracked, sequence.keyframe(), frame);
      expectConsistent(fused);
      error = std::abs(
          static_cast<double>(fused.depth.mean(60, 60) / sequence.trueDepth(Sequence::pose(n))(60, 60)) -
          1.0);
    }
    if (compensate) {
      EXPECT_LT(error, 0.002);
    } else {
      EXPECT_GT(error, 0.003);
    }
  }
}

TEST(DepthFusionSensor, FarDepthIsKeptAndHasNoSayInTheScale) {
  const Sequence sequence(2.0);
  DepthFusion fusion(sequence.camera(), options()), without(sequence.camera(), options());
  for (int n = 0; n < 3; ++n) {
    const DepthImage truth = sequence.trueDepth(Sequence::pose(n));
    RgbdFrame frame = sequence.frame(n);
    const FusedFrame expected = without.fuse(sequence.tracked(n), sequence.keyframe(), frame);
    int far = 0;
    for (int y = 0; y < truth.rows; ++y) {
      for (int x = 0; x < truth.cols; ++x) {
        if (!(truth(y, x) > 5.3f && truth(y, x) < 20.0f)) continue;
        frame.depth(y, x) = (1.0f - 0.01f * (truth(y, x) - 4.0f)) * truth(y, x);  // biased as in sensors
        ++far;
      }
    }
    ASSERT_GT(far, 1000);
    const FusedFrame fused = fusion.fuse(sequence.tracked(n), sequence.keyframe(), frame);
    expectConsistent(fused);
    EXPECT_NEAR(fused.scale.alpha, expected.scale.alpha, 1e-4) << "where they begin, slopes are better known";
    EXPECT_NEAR(fused.scale.sigma, expected.scale.sigma, 2e-4);
    double squares = 0.0;
    for (int y = 0; y < frame.depth.rows; ++y) {
      for (int x = 0; x < frame.depth.cols; ++x) {
        if (!(frame.depth(y, x) > 5.0f)) continue;
        ASSERT_EQ(fused.provenance(y, x) & 1, 1) << "there is depth wherever the input has it";
        const double error = static_cast<double>(fused.depth.mean(y, x) - truth(y, x));
        squares += error * error / static_cast<double>(fused.depth.variance(y, x));
      }
    }
    EXPECT_LT(squares / far, 2.0);
  }
}

TEST(DepthFusionSensor, DropsSfmInHolesBesideWhatTheSensorSees) {
  const Sequence sequence(1.0);
  const cv::Rect hole(40, 30, 60, 50);
  for (const int width : {0, 3, 7}) {
    FusionOptions chosen = options();
    chosen.rim_width = width;
    chosen.reject_reflections = false;
    chosen.gaussian.min_inlier_probability = 0.0;
    DepthFusion fusion(sequence.camera(), chosen);
    RgbdFrame frame = sequence.frame(1);
    frame.depth(hole).setTo(kNone);
    const FusedFrame fused = fusion.fuse(sequence.tracked(1), sequence.keyframe(), frame);
    expectConsistent(fused);
    const cv::Rect inside(hole.x + width, hole.y + width, hole.width - 2 * width, hole.height - 2 * width);
    cv::Mat sfm_only = fused.provenance == static_cast<int>(Provenance::kSfm);
    const int in_hole = cv::countNonZero(sfm_only(hole)), in_middle = cv::countNonZero(sfm_only(inside));
    EXPECT_GT(in_middle, 0) << width;
    EXPECT_EQ(in_hole, width == 0 ? in_hole : in_middle) << width;
    EXPECT_EQ(cv::countNonZero(fused.sfm.mean(hole) > 0.0F), in_hole) << width;
  }
}

TEST(DepthFusionSensor, AFrameThatMostlyContradictsIsSensorOnly) {
  const Sequence sequence(1.0);
  FusionOptions chosen = options();
  chosen.reject_reflections = false;
  for (const bool wrong : {false, true}) {
    DepthFusion fusion(sequence.camera(), chosen);
    for (int n = 0; n < 3; ++n) sequence.fuse(fusion, n);
    RgbdFrame frame = sequence.frame(3);
    const int middle = frame.depth.cols / 2;
    if (wrong) makeWrong(frame.depth);
    frame.depth(cv::Rect(middle, 0, 20, frame.depth.rows)).setTo(static_cast<double>(kNone));
    const FusedFrame fused = fusion.fuse(sequence.tracked(3), sequence.keyframe(), frame);
    expectConsistent(fused);
    EXPECT_EQ(fused.sfm_rejected, wrong);
    EXPECT_EQ(fused.counts.fused == 0, wrong);
    EXPECT_EQ(fused.counts.sfm_only == 0, wrong);
    if (!wrong) continue;
    EXPECT_GT(fused.disagreeing, 2000u);
    EXPECT_EQ(fused.disagreeing, static_cast<std::uint64_t>(cv::countNonZero(fused.disagreement)));
    const cv::Mat without = (fused.disagreement != 0) & ~(fused.depth.mean > 0.0);
    EXPECT_EQ(cv::countNonZero(without), 0) << "nothing is kept where the sensor has nothing";
  }
}

/// Wild depths, by themselves and in short rows, on the surface and in a hole.
TEST(DepthFusionSensor, StraysHaveNoVoteAndWinNowhere) {
  const Sequence sequence(1.0);
  const cv::Rect hole(40, 30, 60, 50);
  FusionOptions chosen = options();
  chosen.reject_reflections = false;
  chosen.rim_width = 0;
  chosen.gaussian.max_disagreement = 0.1;
  chosen.gaussian.min_inlier_probability = 0.0;  // SfM's depth is not judged
  DepthFusion fusion(sequence.camera(), chosen), without(sequence.camera(), chosen);
  for (int n = 0; n < 4; ++n) {
    RgbdFrame frame = sequence.frame(n);
    frame.depth(hole).setTo(kNone);
    const FusedFrame expected = without.fuse(sequence.tracked(n), sequence.keyframe(), frame);
    const DepthImage truth = sequence.trueDepth(Sequence::pose(n));
    for (int y = 4; y < frame.depth.rows - 8; y += 8) {
      for (int x = 3; x < frame.depth.cols - 8; x += 8) {
        frame.depth(y, x) = 0.5F * truth(y, x);
        for (int i = 0; i < 3; ++i) frame.depth(y + 4, x + i) = 0.5F * truth(y + 4, x);
      }
    }
    const FusedFrame fused = fusion.fuse(sequence.tracked(n), sequence.keyframe(), frame);
    expectConsistent(fused);
    EXPECT_NEAR(fused.scale.alpha, expected.scale.alpha, 0.003);
    EXPECT_FALSE(fused.sfm_rejected);
    EXPECT_LE(fused.disagreeing, expected.disagreeing + 5);
    EXPECT_GT(fused.counts.sfm_only, 0.9 * static_cast<double>(expected.counts.sfm_only));
    int kept = 0;
    for (int y = 4; y < frame.depth.rows - 8; y += 8) {
      for (int x = 3; x < frame.depth.cols - 8; x += 8) {
        if (expected.provenance(y, x) != 0) {
          EXPECT_FALSE(fused.depth.mean(y, x) < 0.7F * truth(y, x)) << "contradicted: " << x << ' ' << y;
        }
        for (int i = 0; i < 3; ++i) {
          const float z = fused.depth.mean(y + 4, x + i), v = fused.depth.variance(y + 4, x + i);
          if (expected.provenance(y + 4, x + i) >= 2) {  // SfM has depth
            EXPECT_FALSE(z < 0.7F * truth(y + 4, x + i)) << x + i << ' ' << y + 4;
          }
          if (!(z < 0.7F * truth(y + 4, x + i))) continue;
          EXPECT_NEAR(std::sqrt(v) / z, kMaxRelativeSigma, 1e-3F);
          ++kept;
        }
      }
    }
    EXPECT_GT(kept, 100);
  }
}

TEST(DepthFusionSensor, MirrorsOfAFrameThatContradictsDoNotBlockCompletion) {
  const Sequence sequence(1.0);
  const cv::Rect hole(32, 48, 32, 32), plane(4, 20, 88, 88);
  auto keyframe = std::make_shared<KeyframeMap>(*sequence.keyframe());
  keyframe->depth.mean = keyframe->depth.mean.clone();
  cv::Mat(keyframe->depth.mean(hole)) *= 3.0;  // what a mirror shows
  for (const bool contradicts : {false, true}) {
    FusionOptions chosen = options();
    chosen.gaussian.max_disagreement = 0.1;
    DepthFusion fusion(sequence.camera(), chosen);
    FusedFrame fused;
    for (int n = 0; n < 4; ++n) {
      RgbdFrame frame = sequence.frame(n);
      frame.grey = GreyImage(frame.depth.size(), std::uint8_t{100});
      frame.depth(hole).setTo(kNone);
      const DepthImage around = frame.depth(plane).clone();
      if (n == 3 && contradicts) makeWrong(frame.depth);
      around.copyTo(frame.depth(plane));
      fused = fusion.fuse(sequence.tracked(n), keyframe, frame);
    }
    EXPECT_EQ(fused.sfm_rejected, contradicts);
    const int completed =
        cv::countNonZero(fused.provenance(hole) == static_cast<int>(Provenance::kCompleted));
    EXPECT_EQ(completed > 0, contradicts) << completed;
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
