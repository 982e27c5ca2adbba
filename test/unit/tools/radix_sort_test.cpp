// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/radix_sort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace rgbd_sfm_fusion {
namespace {

TEST(RadixSort, GivesTheOrderOfNumbers) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> exponent(-30.0f, 30.0f);
  for (const std::size_t size : {0u, 1u, 2u, 5000u}) {
    std::vector<float> values(size);
    for (float& value : values) value = (random() % 2 == 0 ? 1.0f : -1.0f) * std::exp2(exponent(random));
    std::vector<float> expected = values;
    std::sort(expected.begin(), expected.end());
    radixSort(&values);
    EXPECT_EQ(values, expected);
  }
}

TEST(RadixSort, TakesEqualAndExtremeNumbers) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::vector<float> values{1.0f, kInfinity, -1.0f, 0.0f, 1.0f, -kInfinity, 1e-42f, -1e-42f, 1.0f};
  radixSort(&values);
  EXPECT_EQ(values,
            (std::vector<float>{-kInfinity, -1.0f, -1e-42f, 0.0f, 1e-42f, 1.0f, 1.0f, 1.0f, kInfinity}));
}

}  // namespace
}  // namespace rgbd_sfm_fusion
