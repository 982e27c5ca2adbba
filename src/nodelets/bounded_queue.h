// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

namespace rgbd_sfm_fusion {

/// Passes items from one thread to another. If items come faster than they are taken, the oldest are dropped,
/// so the delay is never longer than the queue.
template <class Item>
class BoundedQueue {
 public:
  explicit BoundedQueue(std::size_t capacity) : capacity_(capacity) {}

  /// @return the item that was dropped for it, if any
  std::optional<Item> push(Item item) {
    return push(std::move(item), [](const Item&) {});
  }

  /// @param overtake  called with each item that waits already; nothing is taken meanwhile
  template <class Function>
  std::optional<Item> push(Item item, Function overtake) {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (Item& waiting : items_) overtake(waiting);
    std::optional<Item> dropped;
    if (items_.size() >= capacity_) {
      dropped = std::move(items_.front());
      items_.pop_front();
    }
    items_.push_back(std::move(item));
    changed_.notify_one();
    return dropped;
  }

  bool empty() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return items_.empty();
  }

  /// Waits for an item. @return nothing once the queue is closed
  std::optional<Item> pop() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return !items_.empty() || closed_; });
    if (closed_) return std::nullopt;
    std::optional<Item> item = std::move(items_.front());
    items_.pop_front();
    return item;
  }

  void close() {
    const std::lock_guard<std::mutex> lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }

 private:
  std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> items_;
  bool closed_ = false;
};

}  // namespace rgbd_sfm_fusion
