// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// The map that is published for fusion.
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "rgbd_sfm_fusion/image/row_bands.h"
#include "visual_odometry_fixture.h"

namespace rgbd_sfm_fusion {
namespace {

TEST_F(VisualOdometryTest, SmoothingWhatIsPublishedMovesNoPoseAndMakesItBetter) {
  OdometryOptions rough_options = options_;
  rough_options.mapping.smooth_published = false;
  VisualOdometry smooth(scene_.camera(), options_), rough(scene_.camera(), rough_options);
  std::shared_ptr<const KeyframeMap> smoothed, raw;
  for (int i = 0; i < 20; ++i) {
    const TrackingResult a = smooth.track(frame(i)), b = rough.track(frame(i));
    ASSERT_EQ(a.T_first_frame.log(), b.T_first_frame.log()) << i;
    smoothed = smooth.map();
    raw = rough.map();
  }
  EXPECT_EQ(cv::countNonZero((smoothed->depth.mean > 0.0F) != (raw->depth.mean > 0.0F)), 0);
  const SE3 T_keyframe_world = raw->T_first_keyframe.inverse() * T_camera_world(0);
  double smoothed_error = 0.0, raw_error = 0.0;
  for (int v = 0; v < raw->depth.mean.rows; ++v) {
    for (int u = 0; u < raw->depth.mean.cols; ++u) {
      if (!(raw->depth.mean(v, u) > 0.0F)) continue;
      const double truth = scene_.depth(T_keyframe_world, u, v);
      smoothed_error += std::abs(static_cast<double>(smoothed->depth.mean(v, u)) / truth - 1.0);
      raw_error += std::abs(static_cast<double>(raw->depth.mean(v, u)) / truth - 1.0);
    }
  }
  EXPECT_LT(smoothed_error, 0.95 * raw_error);
}

TEST_F(VisualOdometryTest, MonocularStereoNeverSeesLaterSensorDepth) {
  options_.sensor_feedback = false;
  VisualOdometry honest(scene_.camera(), options_), falsified(scene_.camera(), options_);
  for (int i = 0; i < 20; ++i) {
    RgbdFrame false_frame = frame(i);
    if (i > 0) false_frame.depth *= 1.1;
    honest.track(frame(i));
    falsified.track(false_frame);
    const auto a = honest.map(), b = falsified.map();
    ASSERT_TRUE(sameBits(a->depth.mean, b->depth.mean)) << i;
    ASSERT_TRUE(sameBits(a->depth.variance, b->depth.variance)) << i;
  }
}

TEST_F(VisualOdometryTest, PublishesNothingFromSensorDepthAlone) {
  VisualOdometry odometry(scene_.camera(), options_);
  // A camera that stands still or turns has no parallax, whatever the sensor sees.
  for (int i = 0; i < 8; ++i) {
    odometry.track(scene_.frame((i + 1) * kPeriod, motion(0, 0, 0, 0, 0.004 * i, 0), 2.0,
                                static_cast<std::uint64_t>(i) + 1));
    const auto map = odometry.map();
    ASSERT_TRUE(map);
    cv::Mat has_depth = map->depth.mean > 0.0;
    EXPECT_LT(cv::countNonZero(has_depth), 500) << i;
  }
}

/// Of a camera that hardly moves, a few bands of rows are enough in each frame; the others stay.
TEST_F(VisualOdometryTest, AFrameOfASlowCameraRenewsAPartOfTheMap) {
  VisualOdometry odometry(scene_.camera(), options_);
  std::shared_ptr<const KeyframeMap> before, map;
  std::vector<bool> changed(static_cast<std::size_t>(scene_.camera().height / RowBands::kRows + 1), false);
  for (int i = 0; i < 16; ++i) {
    const SE3 T = motion(0.004 * i, 0, 0);
    odometry.track(scene_.frame((i + 1) * kPeriod, T, 2.0, static_cast<std::uint64_t>(i)));
    before = map;
    map = odometry.map();
    if (i < 12) continue;
    std::size_t rows = 0;
    for (int v = 0; v < map->depth.mean.rows; ++v) {
      if (sameBits(map->depth.mean.row(v), before->depth.mean.row(v))) continue;
      ++rows;
      changed[static_cast<std::size_t>(v / RowBands::kRows)] = true;
    }
    EXPECT_GT(rows, 0U) << i;
    EXPECT_LE(rows, 3U * RowBands::kRows) << i;
  }
  EXPECT_GT(std::count(changed.begin(), changed.end(), true), 6);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
