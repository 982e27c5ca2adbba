// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/reprojection.h"

#include <gtest/gtest.h>

#include "unit/fusion/depth_images.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr float kWall = 2.0f;  // [m] depth of the wall in the first keyframe

/// A wall and two keyframes. The first keyframe has estimates of the whole wall. The second is nearer. It has
/// only the left half of the wall, and a post in front of the right half: two columns with no depth between
/// them.
class TwoKeyframes : public testing::Test {
 protected:
  TwoKeyframes() {
    first_ = keyframe(1, test::withRelativeSigma(test::constant({160, 120}, kWall), 0.02f));
    DepthImage second(120, 160, kNone);
    second.colRange(0, 80).setTo(1.9);
    for (const int x : {120, 122}) second.col(x).setTo(1.0);
    second_ = keyframe(2, test::withRelativeSigma(second, 0.02f));
  }

  static std::shared_ptr<const KeyframeMap> keyframe(Stamp stamp, const GaussianDepth& depth) {
    auto map = std::make_shared<KeyframeMap>();
    map->camera = test::smallCamera();
    map->stamp = stamp;
    map->camera = test::smallCamera();
    map->depth = depth;
    return map;
  }

  static TrackingResult tracked(const KeyframeMap& keyframe, double z_keyframe, double z_frame) {
    TrackingResult result;
    result.state = TrackingState::kTracking;
    result.keyframe_stamp = keyframe.stamp;
    result.T_frame_keyframe = {Eigen::Quaterniond::Identity(), {0, 0, z_keyframe - z_frame}};
    result.T_first_frame = {Eigen::Quaterniond::Identity(), {0, 0, z_frame}};
    return result;
  }

  GaussianDepth complete(const std::shared_ptr<const KeyframeMap>& map, const TrackingResult& tracked) {
    return previous_keyframe_.fillGaps(tracked, map, ReprojectionOptions(), pool_);
  }

  static constexpr float kNone = test::kNone;
  std::shared_ptr<const KeyframeMap> first_, second_;
  PreviousKeyframe previous_keyframe_;
  ImagePool pool_;
};

TEST_F(TwoKeyframes, TheFirstIsLeftAsItIs) {
  for (const double z : {0.0, 0.05}) {
    const GaussianDepth depth = complete(first_, tracked(*first_, 0.0, z));
    EXPECT_TRUE(test::sameBits(depth.mean, first_->depth.mean));
    EXPECT_TRUE(test::sameBits(depth.variance, first_->depth.variance));
  }
}

TEST_F(TwoKeyframes, WhatTheNewOneLacksComesFromTheOneBefore) {
  complete(first_, tracked(*first_, 0.0, 0.08));
  for (const double z : {0.1, 0.13}) {  // the new keyframe itself, and a frame after it
    const GaussianDepth depth = complete(second_, tracked(*second_, 0.1, z));
    EXPECT_TRUE(test::isConsistent(depth));
    int carried = 0, of_its_own = 0;
    for (int y = 2; y < 118; ++y) {
      for (int x = 2; x < 158; ++x) {
        const float own = second_->depth.mean(y, x);
        if (own > 0.0f) {
          ++of_its_own;
          ASSERT_EQ(depth.mean(y, x), own);
          ASSERT_EQ(depth.variance(y, x), second_->depth.variance(y, x));
        } else if (depth.mean(y, x) > 0.0f) {
          ++carried;
          ASSERT_NEAR(depth.mean(y, x), kWall - 0.1f, 1e-4f);
          ASSERT_GE(std::sqrt(depth.variance(y, x)), 0.999f * 0.02f * kWall);
        }
      }
    }
    EXPECT_GT(of_its_own, 116 * 70);
    EXPECT_GT(carried, 116 * 70) << "of 116 x 76 without estimates of the new keyframe";
    EXPECT_TRUE(std::isnan(depth.mean(60, 121))) << "the post hides it";
    EXPECT_TRUE(std::isnan(depth.mean(60, 119))) << "and beside it, where its border may be";
  }
}

TEST_F(TwoKeyframes, NothingIsCarriedOnceBothAreForgotten) {
  complete(first_, tracked(*first_, 0.0, 0.08));
  previous_keyframe_.reset();
  EXPECT_TRUE(test::sameBits(complete(second_, tracked(*second_, 0.1, 0.1)).mean, second_->depth.mean));
}

TEST_F(TwoKeyframes, KeyframesAreNeverChanged) {
  const DepthImage first = first_->depth.mean.clone(), second = second_->depth.mean.clone();
  complete(first_, tracked(*first_, 0.0, 0.0));
  complete(second_, tracked(*second_, 0.0, 0.0));  // at the same place
  complete(second_, tracked(*second_, 0.0, 0.1));
  complete(first_, tracked(*first_, 0.0, 0.1));
  EXPECT_TRUE(test::sameBits(first_->depth.mean, first));
  EXPECT_TRUE(test::sameBits(second_->depth.mean, second));
}

}  // namespace
}  // namespace rgbd_sfm_fusion
