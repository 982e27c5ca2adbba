// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/tracking_reference.h"

#include <gtest/gtest.h>

#include <limits>

#include "synthetic_views.h"

namespace rgbd_sfm_fusion {
namespace {

/// Points at half resolution, of a textured image whose depth has a step at an odd column, so that one column
/// of the coarse pixels has depths of both sides.
class TrackingReferenceAtAStep : public testing::Test {
 protected:
  static constexpr int kColumn = 41;
  static constexpr float kFar = 0.5F, kNear = 0.6F;  // [1/m]

  const ReferencePoints& points(float max_step) {
    const PlaneScene scene(smallCamera());
    ImagePyramid pyramid;
    pyramid.build(scene.frame(0, SE3()).grey, 2);
    InverseDepthImage depth;
    depth.create(pyramid[0].size());
    depth.mean.setTo(static_cast<double>(kFar));
    depth.mean.colRange(kColumn, depth.mean.cols).setTo(static_cast<double>(kNear));
    depth.variance.setTo(1e-6);
    reference_.setKeyframe(pyramid, cameraPyramid(scene.camera(), 2));
    reference_.setDepth(depth, ReadoutMotion(), 0.0F, 1, max_step);
    return reference_.points(1);
  }

  /// Points with a depth between those of the two sides.
  static int between(const ReferencePoints& points) {
    int count = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i)
      count += points.inverse_depth[i] > 1.01F * kFar && points.inverse_depth[i] < 0.99F * kNear ? 1 : 0;
    return count;
  }

  TrackingReference reference_;
};

TEST_F(TrackingReferenceAtAStep, NoPointHasADepthOfNeitherSide) {
  const int all = points(std::numeric_limits<float>::infinity()).count;
  EXPECT_GT(between(reference_.points(1)), 10);
  const int kept = points(0.03F).count;
  EXPECT_EQ(between(reference_.points(1)), 0);
  EXPECT_GT(kept, all / 2);
}

TEST_F(TrackingReferenceAtAStep, ASmallerStepCostsNoPoint) {
  const int all = points(std::numeric_limits<float>::infinity()).count;
  EXPECT_EQ(points(0.25F).count, all);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
