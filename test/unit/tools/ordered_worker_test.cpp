// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tools/ordered_worker.h"

#include <gtest/gtest.h>

#include <memory>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace rgbd_sfm_fusion {
namespace {

class OrderedWorkerTest : public ::testing::TestWithParam<std::size_t> {};

TEST_P(OrderedWorkerTest, DoesEverythingInOrder) {
  std::vector<int> done;
  OrderedWorker<std::unique_ptr<int>> worker(GetParam(), [&](std::unique_ptr<int> i) { done.push_back(*i); });
  for (int i = 0; i < 1000; ++i) worker.push(std::make_unique<int>(i));
  worker.finish();
  std::vector<int> expected(1000);
  std::iota(expected.begin(), expected.end(), 0);
  EXPECT_EQ(done, expected);
}

TEST_P(OrderedWorkerTest, PassesOnAnErrorAndDoesNoMore) {
  int done = 0;
  OrderedWorker<int> worker(GetParam(), [&](int i) {
    if (i == 3) throw std::runtime_error("three");
    ++done;
  });
  const auto push_all = [&] {
    for (int i = 0; i < 1000; ++i) worker.push(i);
    worker.finish();
  };
  EXPECT_THROW(push_all(), std::runtime_error);
  EXPECT_EQ(done, 3);
}

TEST_P(OrderedWorkerTest, MayBeGivenUp) {
  OrderedWorker<int> worker(GetParam(), [](int) {});
  worker.push(1);
}

INSTANTIATE_TEST_SUITE_P(Capacities, OrderedWorkerTest, ::testing::Values(0, 1, 4));

}  // namespace
}  // namespace rgbd_sfm_fusion
