// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// What completion changes in a fused frame, and what it leaves.
#include <gtest/gtest.h>

#include "rgbd_sfm_fusion/fusion/depth_fusion.h"
#include "rgbd_sfm_fusion/sensor/stray_depth.h"
#include "unit/fusion/fusion_sequence.h"

namespace rgbd_sfm_fusion {
namespace {

using test::Sequence;

/// Texture everywhere: nothing hides SfM's depth. The mean brightness is the same everywhere.
RgbdFrame withImage(RgbdFrame frame) {
  frame.grey = GreyImage(frame.depth.size(), std::uint8_t{90});
  for (int x = 0; x < frame.grey.cols; x += 2) frame.grey.col(x).setTo(110);
  return frame;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size()) return false;
  return cv::countNonZero((a != b) & ((a == a) | (b == b))) == 0;  // two NaN are equal
}

TEST(CompletedFusion, OffIsAsWithoutAnImage) {
  const Sequence sequence(1.3);
  FusionOptions off = test::options();
  off.complete = false;
  DepthFusion with(sequence.camera(), off), without(sequence.camera(), test::options());
  for (int n = 0; n < 4; ++n) {
    const FusedFrame a = with.fuse(sequence.tracked(n), sequence.keyframe(), withImage(sequence.frame(n)));
    const FusedFrame b = without.fuse(sequence.tracked(n), sequence.keyframe(), sequence.frame(n));
    EXPECT_TRUE(same(a.depth.mean, b.depth.mean));
    EXPECT_TRUE(same(a.depth.variance, b.depth.variance));
    EXPECT_TRUE(same(a.provenance, b.provenance));
    EXPECT_EQ(a.counts.completed, 0U);
  }
}

TEST(CompletedFusion, SfmIsDroppedWhereTheImageIsPlain) {
  const Sequence sequence(1.3);
  FusionOptions off = test::options();
  off.complete = false;
  RgbdFrame frame = withImage(sequence.frame(0));
  frame.grey.colRange(0, frame.grey.cols / 2).setTo(20);  // a dark screen comes before the left half
  const FusedFrame fused =
      DepthFusion(sequence.camera(), off).fuse(sequence.tracked(0), sequence.keyframe(), frame);
  const cv::Mat seen = (fused.sfm.mean == fused.sfm.mean) & ~(frame.depth > 0.0F);
  EXPECT_EQ(cv::countNonZero(seen.colRange(0, seen.cols / 2 - 2)), 0);
  EXPECT_GT(cv::countNonZero(seen.colRange(seen.cols / 2, seen.cols)), 0);
}

TEST(CompletedFusion, OnlyPixelsWithoutDepthAndStraysChange) {
  const Sequence sequence(1.3);
  FusionOptions off = test::options();
  off.complete = false;
  DepthFusion on(sequence.camera(), test::options()), reference(sequence.camera(), off);
  std::uint64_t completed = 0;
  for (int n = 0; n < 8; ++n) {
    const RgbdFrame frame = withImage(sequence.frame(n));
    const FusedFrame a = on.fuse(sequence.tracked(n), sequence.keyframe(), frame);
    const FusedFrame b = reference.fuse(sequence.tracked(n), sequence.keyframe(), frame);
    const DepthImage sensor = withNoise(sortStrays(frame.depth, {}), {}).mean;
    const cv::Mat measured = (sensor > 0.0F) | (b.provenance > static_cast<int>(Provenance::kSensor));
    EXPECT_EQ(cv::countNonZero((a.provenance != b.provenance) & measured), 0);
    EXPECT_EQ(cv::countNonZero((a.depth.mean != b.depth.mean) & measured), 0);
    EXPECT_EQ(cv::countNonZero((a.depth.variance != b.depth.variance) & measured), 0);
    EXPECT_EQ(a.counts.completed, static_cast<std::uint64_t>(cv::countNonZero(a.provenance == 4)));
    EXPECT_EQ(a.counts.without, static_cast<std::uint64_t>(cv::countNonZero(a.provenance == 0)));
    EXPECT_EQ(b.counts.total() - a.counts.total(),
              static_cast<std::uint64_t>(cv::countNonZero((a.provenance == 4) & (b.provenance == 1))));
    EXPECT_EQ(a.scale.alpha, b.scale.alpha);
    completed += a.counts.completed;
  }
  EXPECT_GT(completed, 0U);
}

TEST(CompletedFusion, RefilledIsOfPixelsWithoutSensorDepth) {
  ProvenanceCounts counts;
  EXPECT_EQ(counts.refilledShare(), 0.0);
  EXPECT_EQ(counts.completedShare(), 0.0);
  counts.sensor_only = 50, counts.fused = 10, counts.sfm_only = 10, counts.completed = 20,
  counts.without = 10;
  EXPECT_DOUBLE_EQ(counts.refilledShare(), 0.75);
  EXPECT_DOUBLE_EQ(counts.completedShare(), 0.2);
  EXPECT_DOUBLE_EQ(counts.sfmOnlyShare(), 1.0 / 7.0);
  counts += counts;
  EXPECT_DOUBLE_EQ(counts.refilledShare(), 0.75);
}

TEST(CompletedFusion, ThePapersMethodCompletesNothing) {
  EXPECT_FALSE(FusionOptions::paper().complete);
  EXPECT_TRUE(FusionOptions().complete);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
