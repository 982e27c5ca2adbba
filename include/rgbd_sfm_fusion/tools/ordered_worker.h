// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace rgbd_sfm_fusion {

/// Hands items to a function, one after the other and in order, in a thread of its own or in the caller's.
/// Both give the same results.
template <class Item>
class OrderedWorker {
 public:
  /// @param capacity  how many items may wait; 0: there is no thread, and push() does the work
  OrderedWorker(std::size_t capacity, std::function<void(Item)> work)
      : capacity_(capacity), work_(std::move(work)) {
    if (capacity > 0) thread_ = std::thread([this] { run(); });
  }

  /// Items that still wait are dropped.
  ~OrderedWorker() { stop(false); }

  OrderedWorker(const OrderedWorker&) = delete;
  OrderedWorker& operator=(const OrderedWorker&) = delete;

  /// Waits while too many items wait. Throws what the function threw for an earlier item.
  void push(Item item) {
    if (capacity_ == 0) return work_(std::move(item));
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return items_.size() < capacity_ || error_; });
    if (error_) std::rethrow_exception(error_);
    items_.push_back(std::move(item));
    changed_.notify_all();
  }

  /// Waits until all items but the last `count` are done. Throws what the function threw.
  void waitForAllBut(std::size_t count) {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [&] { return items_.size() + (is_working_ ? 1 : 0) <= count || error_; });
    if (error_) std::rethrow_exception(error_);
  }

  /// Waits until all is done. Throws what the function threw.
  void finish() {
    stop(true);
    if (error_) std::rethrow_exception(error_);
  }

 private:
  void stop(bool do_the_rest) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      stopping_ = true;
      if (!do_the_rest) items_.clear();
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
  }

  std::optional<Item> take() {
    std::unique_lock<std::mutex> lock(mutex_);
    is_working_ = false;
    changed_.notify_all();
    changed_.wait(lock, [this] { return !items_.empty() || stopping_; });
    if (items_.empty()) return std::nullopt;
    std::optional<Item> item = std::move(items_.front());
    items_.pop_front();
    is_working_ = true;
    changed_.notify_all();
    return item;
  }

  void run() {
    try {
      while (std::optional<Item> item = take()) work_(*std::move(item));
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex_);
      error_ = std::current_exception();
      changed_.notify_all();
    }
  }

  std::size_t capacity_;
  std::function<void(Item)> work_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> items_;
  std::exception_ptr error_;
  bool is_working_ = false;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace rgbd_sfm_fusion
