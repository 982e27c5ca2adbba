// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace rgbd_sfm_fusion {

/// Objects that are handed out, and used again once nobody else holds them: what they have allocated stays.
/// Any thread may let go of an object.
template <class T>
class SharedPool {
 public:
  /// @return an object as its last holder left it, or a new one
  std::shared_ptr<T> take() {
    for (const std::shared_ptr<T>& object : objects_) {
      // The count says nothing of what the last holder did with the object. The copy does: it adds to the
      // count that the holder took from, and both are ordered (std::memory_order_acq_rel).
      if (object.use_count() == 1) return object;
    }
    auto object = std::make_shared<T>();
    if (objects_.size() < kMostObjects) objects_.push_back(object);
    return object;
  }

 private:
  static constexpr std::size_t kMostObjects = 64;
  std::vector<std::shared_ptr<T>> objects_;
};

}  // namespace rgbd_sfm_fusion
