// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/bounded_queue.h"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <thread>

namespace rgbd_sfm_fusion {
namespace {

TEST(BoundedQueue, KeepsOrderAndDropsTheOldest) {
  BoundedQueue<std::unique_ptr<int>> queue(2);
  EXPECT_FALSE(queue.push(std::make_unique<int>(1)));
  EXPECT_FALSE(queue.push(std::make_unique<int>(2)));
  const std::optional<std::unique_ptr<int>> dropped = queue.push(std::make_unique<int>(3));
  ASSERT_TRUE(dropped);
  EXPECT_EQ(**dropped, 1);
  EXPECT_EQ(**queue.pop(), 2);
  EXPECT_EQ(**queue.pop(), 3);
}

TEST(BoundedQueue, WhatWaitsIsToldThatItIsOvertaken) {
  BoundedQueue<int> queue(3);
  const auto overtake = [](int& waiting) { waiting += 10; };
  queue.push(1, overtake);
  queue.push(2, overtake);
  EXPECT_EQ(queue.pop(), 11);
  queue.push(3, overtake);
  EXPECT_EQ(queue.pop(), 12);
  EXPECT_EQ(queue.pop(), 3);
}

TEST(BoundedQueue, PopWaitsForAnItemOrTheEnd) {
  BoundedQueue<int> queue(1);
  std::thread producer([&] { queue.push(7); });
  EXPECT_EQ(queue.pop(), 7);
  producer.join();
  std::thread closer([&] { queue.close(); });
  EXPECT_EQ(queue.pop(), std::nullopt);
  closer.join();
}

TEST(BoundedQueue, ClosedItGivesNothingMore) {
  BoundedQueue<int> queue(3);
  queue.push(1);
  queue.close();
  EXPECT_EQ(queue.pop(), std::nullopt);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
