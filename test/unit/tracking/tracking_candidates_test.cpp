// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/tracking_candidates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "synthetic_views.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kLevels = 4;

class TrackingCandidatesTest : public testing::Test {
 protected:
  TrackingCandidatesTest() {
    ImagePyramid pyramid;
    pyramid.build(scene_.frame(0, SE3()).grey, kLevels);
    candidates_.setKeyframe(pyramid, cameraPyramid(scene_.camera(), kLevels), {2.0F});
  }

  /// Inverse depth at some of the pixels.
  InverseDepthImage depth(int seed) const {
    InverseDepthImage result;
    result.create({scene_.camera().width, scene_.camera().height});
    result.clear();
    cv::RNG random(static_cast<std::uint64_t>(seed));
    for (int v = 0; v < scene_.camera().height; ++v) {
      for (int u = 0; u < scene_.camera().width; ++u) {
        if (random.uniform(0, 3) == 0) continue;
        result.mean(v, u) = random.uniform(0.2F, 2.0F), result.variance(v, u) = random.uniform(1e-4F, 1e-2F);
      }
    }
    return result;
  }

  PlaneScene scene_{smallCamera()};
  TrackingCandidates candidates_;
};

void expectSame(const ReferencePoints& a, const ReferencePoints& b) {
  ASSERT_EQ(a.count, b.count);
  EXPECT_EQ(a.ends, b.ends);
  for (const auto array : {&ReferencePoints::x, &ReferencePoints::y, &ReferencePoints::inverse_depth,
                           &ReferencePoints::inverse_depth_variance, &ReferencePoints::intensity,
                           &ReferencePoints::gradient_x, &ReferencePoints::gradient_y}) {
    EXPECT_TRUE(std::equal((a.*array).begin(), (a.*array).begin() + a.count, (b.*array).begin()));
  }
}

TEST_F(TrackingCandidatesTest, CollectedInSomeBandsAreThoseCollectedInAll) {
  const ReadoutMotion motion{(Vector6() << 0.01, 0.0, 0.0, 0.0, 0.02, 0.0).finished()};
  const RowBands bands{1, 3};
  InverseDepthImage mixed = depth(1);
  TrackingReference before, all, some;
  candidates_.collect(mixed, motion, {}, {}, before);
  const InverseDepthImage renewed = depth(2);
  bands.forEach(mixed.mean.rows, [&](int first, int end) {
    renewed.mean.rowRange(first, end).copyTo(mixed.mean.rowRange(first, end));
    renewed.variance.rowRange(first, end).copyTo(mixed.variance.rowRange(first, end));
  });
  candidates_.collect(mixed, motion, bands, before, some);
  candidates_.collect(mixed, motion, {}, {}, all);
  for (int level = 0; level < kLevels; ++level) expectSame(some.points(level), all.points(level));
}

TEST_F(TrackingCandidatesTest, EachPointHasADepthAndTheGradientOfItsPixel) {
  TrackingReference reference;
  candidates_.collect(depth(1), ReadoutMotion(), {}, {}, reference);
  const ReferencePoints& points = reference.points(0);
  ASSERT_GT(points.count, 1000);
  for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i) {
    EXPECT_GT(points.inverse_depth[i], 0.0F);
    EXPECT_GE(std::hypot(points.gradient_x[i], points.gradient_y[i]), 2.0F);
  }
}

/// Gradients of noise would count like any other in the information that a pose has.
TEST(TrackingCandidates, OfNoiseAloneThereAreHardlyAny) {
  constexpr double kNoise = 5.0;
  GreyImage even(240, 320);
  cv::RNG(5).fill(even, cv::RNG::NORMAL, 128.0, kNoise);
  ImagePyramid pyramid;
  pyramid.build(even, kLevels);
  InverseDepthImage depth;
  depth.create(even.size());
  depth.mean.setTo(1.0F);
  depth.variance.setTo(1e-4F);
  const auto shareOfPixels = [&](const GradientLimit& limit, int level) {
    TrackingCandidates candidates;
    candidates.setKeyframe(pyramid, cameraPyramid(smallCamera(), kLevels), limit);
    TrackingReference reference;
    candidates.collect(depth, ReadoutMotion(), {}, {}, reference);
    const double candidates_at_most = static_cast<double>(pyramid[level].total()) / (level < 2 ? 2.0 : 1.0);
    return reference.points(level).count / candidates_at_most;
  };
  EXPECT_GT(shareOfPixels({2.0F, 0.0}, 0), 0.6);
  // With a third of the noise, the limit is one sigma of the gradients: 0.6 of them are beyond.
  for (int level = 0; level < kLevels; ++level)
    EXPECT_NEAR(shareOfPixels({0.1F, kNoise / 3.0}, level), 0.6, 0.1) << level;
  for (int level = 0; level < kLevels; ++level)
    EXPECT_LT(shareOfPixels({0.1F, kNoise}, level), 0.03) << level;
}

}  // namespace
}  // namespace rgbd_sfm_fusion
