// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/segments_by_length.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace rgbd_sfm_fusion {
namespace {

constexpr int kLongest = 40;
constexpr int kBlocks = 60;

/// A block whose lanes tell their number by u.
SegmentBlock randomBlock(std::mt19937& random, int first_number) {
  SegmentBlock block;
  for (int l = 0; l < kLanes; ++l) {
    block.before[l] = std::uniform_int_distribution<int>(-3, kLongest / 2)(random);
    block.after[l] = std::uniform_int_distribution<int>(std::max(0, -block.before[l]), kLongest / 2)(random);
    block.u[l] = static_cast<float>(first_number + l);
  }
  return block;
}

int length(const SegmentBlock& block, std::size_t lane) {
  return block.before[lane] + block.after[lane];
}

class SegmentsByLengthTest : public testing::Test {
 protected:
  void put() {
    segments_.setLongest(kLongest);
    std::mt19937 random(1);
    for (int i = 0; i < kBlocks; ++i) {
      const SegmentBlock block = randomBlock(random, i * kLanes);
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        if (const SearchBlock* full = segments_.add(block, lane, i * kLanes + static_cast<int>(lane)))
          take(*full, true);
      }
    }
    segments_.empty([&](const SearchBlock& block) { take(block, false); });
  }

  void take(const SearchBlock& block, bool of_one_length) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      if (of_one_length) {
        EXPECT_EQ(length(block.segments, lane), length(block.segments, 0));
      }
      if (lane >= block.count) {
        EXPECT_EQ(block.segments.u[lane], block.segments.u[block.count - 1]) << "the last one, repeated";
        continue;
      }
      EXPECT_EQ(block.segments.u[lane], static_cast<float>(block.number[lane])) << "the number's own segment";
      EXPECT_TRUE(taken_.insert(block.number[lane]).second) << "once";
    }
    partial_ += block.count < kLanes ? 1 : 0;
  }

  SegmentsByLength segments_;
  std::set<int> taken_;
  int partial_ = 0;
};

TEST_F(SegmentsByLengthTest, EachSegmentIsSearchedOnceAndAllBlocksButOneAreFull) {
  put();
  EXPECT_EQ(taken_.size(), static_cast<std::size_t>(kBlocks * kLanes));
  EXPECT_LE(partial_, 1);
}

TEST_F(SegmentsByLengthTest, NothingIsLeftForTheNextView) {
  put();
  taken_.clear();
  put();
  EXPECT_EQ(taken_.size(), static_cast<std::size_t>(kBlocks * kLanes));
}

}  // namespace
}  // namespace rgbd_sfm_fusion
