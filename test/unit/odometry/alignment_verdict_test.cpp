// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/alignment_verdict.h"

#include <gtest/gtest.h>

namespace rgbd_sfm_fusion {
namespace {

AlignmentResult aligned(double share_good, double share_of_depth, double share_in_view = 0.9) {
  AlignmentResult result;
  result.converged = true;
  result.share_good = share_good;
  result.share_of_depth = share_of_depth;
  result.share_in_view = share_in_view;
  return result;
}

TEST(AlignmentVerdict, AFrameIsObstructedWherePointsAndDepthBothSaySo) {
  EXPECT_TRUE(isObstructed(aligned(0.75, 0.85)));
  EXPECT_FALSE(isObstructed(aligned(0.75, 0.98))) << "half of the keyframe in view, from another side";
  EXPECT_FALSE(isObstructed(aligned(0.95, 0.85))) << "depth that the sensor has wrong";
}

TEST(AlignmentVerdict, WithoutSensorDepthNothingSaysThatAFrameIsObstructed) {
  for (const double share_good : {0.9, 0.6, 0.3, 0.0}) EXPECT_FALSE(isObstructed(aligned(share_good, 1.0)));
}

TEST(AlignmentVerdict, ToRecogniseAKeyframeMostOfItHasToBeInViewAndToFit) {
  const TrackingOptions options;
  EXPECT_TRUE(isRecognised(aligned(0.8, 0.8, 0.8), options));
  EXPECT_FALSE(isRecognised(aligned(0.5, 0.8, 0.8), options));
  EXPECT_FALSE(isRecognised(aligned(0.8, 0.5, 0.8), options));
  EXPECT_FALSE(isRecognised(aligned(0.8, 0.8, 0.4), options));
  AlignmentResult in_other_light = aligned(0.8, 0.8, 0.8);
  in_other_light.photometry.brightness.gain = 0.5;
  EXPECT_FALSE(isRecognised(in_other_light, options));
}

}  // namespace
}  // namespace rgbd_sfm_fusion
