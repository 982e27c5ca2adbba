// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Counts what the process allocates. Images count as well, as OpenCV makes a description of each with `new`.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "rgbd_sfm_fusion/odometry/visual_odometry.h"
#include "rgbd_sfm_fusion/shared_pool.h"
#include "synthetic_views.h"

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

namespace {
std::atomic<long> allocations{0};
}  // namespace

// Replaces the operators of the whole process. If they were inlined, compilers would warn of a mismatch.
__attribute__((noinline)) void* operator new(std::size_t size) {
  ++allocations;
  void* const memory = std::malloc(size);
  if (!memory) throw std::bad_alloc();
  return memory;
}
__attribute__((noinline)) void operator delete(void* memory) noexcept {
  std::free(memory);
}
__attribute__((noinline)) void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace rgbd_sfm_fusion {
namespace {

template <class Call>
long allocationsOf(const Call& call) {
  const long before = allocations;
  call();
  return allocations - before;
}

TEST(Allocations, AreCounted) {
  EXPECT_EQ(allocationsOf([] { const std::vector<int> numbers(100); }), 1);
  EXPECT_GE(allocationsOf([] { const cv::Mat_<float> image(10, 10); }), 1);
}

/// Tracks and maps a camera that sways too little for a new keyframe, and counts.
/// @param body  [px] of a robot that the camera sees a part of; may be empty
/// @return how much of the image is fixed at the end, 0 to 1
double expectNoAllocations(const cv::Rect& body) {
  constexpr int kPeriod = 12, kWarm = 10 * kPeriod;
  const PlaneScene scene(smallCamera());
  GreyImage texture(body.size());
  if (!body.empty()) {
    cv::RNG(7).fill(texture, cv::RNG::UNIFORM, 0, 256);
    cv::blur(texture, texture, {5, 5});
  }
  std::vector<RgbdFrame> frames;
  for (int i = 0; i < kPeriod; ++i) {
    const double sway = 0.02 * std::sin(2.0 * M_PI * i / kPeriod);
    frames.push_back(
        scene.frame(0, motion(sway, 0.3 * sway, 0.5 * sway), 2.0, static_cast<std::uint64_t>(i) + 1));
    if (!body.empty()) texture.copyTo(frames.back().grey(body));
  }
  OdometryOptions options;
  options.tracking.pyramid_levels = 4;
  VisualOdometry odometry(scene.camera(), options);
  std::shared_ptr<const KeyframeMap> map;
  double share = 0.0;
  for (int i = 0; i < kWarm + kPeriod; ++i) {
    RgbdFrame frame = frames[static_cast<std::size_t>(i % kPeriod)];
    frame.stamp = frame.depth_stamp = (i + 1) * Stamp{33'000'000};
    TrackingResult tracked;
    const long of_tracking = allocationsOf([&] { tracked = odometry.track(frame); });
    const long of_mapping = allocationsOf([&] { map = odometry.map(); });
    EXPECT_EQ(tracked.state, TrackingState::kTracking);
    share = tracked.share_fixed_in_view;
    if (i < kWarm) continue;
    EXPECT_NE(tracked.keyframe_stamp, tracked.stamp) << "is meant to refine one keyframe";
    EXPECT_EQ(of_tracking, 0) << "frame " << i;
    EXPECT_EQ(of_mapping, 0) << "frame " << i;
  }
  return share;
}

TEST(Allocations, OfTrackingAndMappingEndAfterTheStart) {
  expectNoAllocations({});
}

TEST(Allocations, EndWhereARobotSeesItself) {
  EXPECT_GT(expectNoAllocations({0, 176, 320, 64}), 0.05);
}

TEST(SharedPool, GivesAnObjectOutAgainOnceNobodyHoldsIt) {
  SharedPool<std::vector<int>> pool;
  auto first = pool.take();
  first->assign(10, 7);
  const std::vector<int>* const memory = first.get();
  EXPECT_NE(pool.take().get(), memory) << "while it is held";
  std::shared_ptr<const std::vector<int>> reader = first;
  first.reset();
  EXPECT_NE(pool.take().get(), memory) << "while another holds it";
  reader.reset();
  const auto again = pool.take();
  EXPECT_EQ(again.get(), memory);
  EXPECT_EQ(again->size(), 10U) << "with its memory";
}

}  // namespace
}  // namespace rgbd_sfm_fusion

#endif
