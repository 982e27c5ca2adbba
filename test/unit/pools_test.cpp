// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cstddef>
#include <memory>
#include <vector>

#include "rgbd_sfm_fusion/image_pool.h"
#include "rgbd_sfm_fusion/shared_pool.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kTakes = 20000;  // more than any burst is remembered for

struct Images {
  ImagePool pool;
  cv::Mat_<float> take() { return pool.take<float>({8, 6}); }
  static const void* address(const cv::Mat_<float>& image) { return image.data; }
};

struct Objects {
  SharedPool<std::vector<int>> pool;
  std::shared_ptr<std::vector<int>> take() { return pool.take(); }
  static const void* address(const std::shared_ptr<std::vector<int>>& object) { return object.get(); }
};

template <class Kind>
class Pools : public testing::Test {};
using Kinds = testing::Types<Images, Objects>;
TYPED_TEST_SUITE(Pools, Kinds);

TYPED_TEST(Pools, UseAgainWhatNobodyHolds) {
  TypeParam kind;
  const void* const first = TypeParam::address(kind.take());
  const auto held = kind.take();
  EXPECT_EQ(TypeParam::address(held), first);
  EXPECT_NE(TypeParam::address(kind.take()), first);
}

TYPED_TEST(Pools, KeepWhatIsAlwaysNeeded) {
  TypeParam kind;
  const auto held = kind.take();
  const void* const second = TypeParam::address(kind.take());
  for (int i = 0; i < kTakes; ++i) ASSERT_EQ(TypeParam::address(kind.take()), second);
}

TYPED_TEST(Pools, LetGoOfWhatABurstHasAdded) {
  TypeParam kind;
  {
    std::vector<decltype(kind.take())> burst;
    for (int i = 0; i < 50; ++i) burst.push_back(kind.take());
    EXPECT_EQ(kind.pool.size(), 50U);
  }
  for (int i = 0; i < kTakes; ++i) kind.take();
  EXPECT_EQ(kind.pool.size(), 1U);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
