// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "rgbd_sfm_fusion/idle_takes.h"

namespace rgbd_sfm_fusion {

/// Objects that are handed out, and used again once nobody else holds them, so that they keep their memory.
/// One thread takes objects, any thread may let go of one. Nobody may hold an object by std::weak_ptr. What a
/// burst has added goes again, as in ImagePool.
template <class T>
class SharedPool {
 public:
  /// @return an object as its last holder left it, or a new one. Only the caller and the pool hold it
  std::shared_ptr<T> take() {
    forgetWhatIsNotNeeded();
    for (const std::shared_ptr<T>& object : objects_) {
      // The last holder has to be done with the object, and what it did has to be visible here. Reading the
      // count does not see to that. The copy that is returned does: it adds to the count that the holder took
      // from, and in libstdc++ both are ordered (acquire and release).
      if (object.use_count() != 1) continue;
      if (&object == &objects_.back()) idle_takes_.restart();
      return object;
    }
    auto object = std::make_shared<T>();
    if (objects_.size() < kMostObjects) objects_.push_back(object);
    return object;
  }

  std::size_t size() const { return objects_.size(); }

 private:
  static constexpr std::size_t kMostObjects = 64;

  void forgetWhatIsNotNeeded() {
    if (objects_.empty() || !idle_takes_.isSurplus(objects_.back().use_count() == 1)) return;
    objects_.pop_back();  // takes from the count, too, and so is ordered as above
    idle_takes_.restart();
  }

  std::vector<std::shared_ptr<T>> objects_;
  IdleTakes idle_takes_;
};

}  // namespace rgbd_sfm_fusion
