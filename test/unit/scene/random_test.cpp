// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/scene/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rgbd_sfm_fusion {
namespace {

double normalised(const CounterRandom& random, std::uint32_t counter) {
  const std::uint32_t sum = (random.twoSums(counter / 2) >> (counter % 2 * 16)) & 0xffffU;
  return (sum - 1.0 * CounterRandom::kSumMean) / static_cast<double>(CounterRandom::kSumSigma);
}

TEST(CounterRandom, SumsHaveTheStatedMomentsAndNoMemory) {
  constexpr std::uint32_t kCount = 1 << 20;
  const double tolerance = 5.0 / std::sqrt(kCount);
  for (const std::uint64_t seed : {0ULL, 1ULL, ~0ULL}) {
    const CounterRandom random(seed, 5, 7);
    double sum = 0, squares = 0, fourths = 0, next = 0, next_row = 0;
    for (std::uint32_t i = 0; i < kCount; ++i) {
      const double x = normalised(random, i);
      sum += x;
      squares += x * x;
      fourths += x * x * x * x;
      next += x * normalised(random, i + 1);
      next_row += x * normalised(random, i + 1920);
    }
    EXPECT_NEAR(sum / kCount, 0.0, tolerance) << seed;
    EXPECT_NEAR(squares / kCount, 1.0, 1.5 * tolerance) << seed;
    EXPECT_NEAR(fourths / kCount, 2.7, 10 * tolerance) << seed;  // of four uniform numbers; a Gaussian has 3
    EXPECT_NEAR(next / kCount, 0.0, tolerance) << seed;
    EXPECT_NEAR(next_row / kCount, 0.0, tolerance) << seed;
  }
}

TEST(CounterRandom, StreamsOfSeedsFramesAndPurposesAreUnrelated) {
  const CounterRandom random(1, 5, 7);
  for (const CounterRandom& other : {CounterRandom(2, 5, 7), CounterRandom(1, 6, 7), CounterRandom(1, 5, 8),
                                     CounterRandom(1 + (1ULL << 32), 5, 7)}) {
    double product = 0;
    for (std::uint32_t i = 0; i < 100000; ++i) product += normalised(random, i) * normalised(other, i);
    EXPECT_LT(std::abs(product / 100000), 0.02);
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
