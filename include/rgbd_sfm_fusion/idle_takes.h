// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rgbd_sfm_fusion {

/// Tells a pool when it can do without its last object. The first ones are taken first, so the last one is in
/// use only while all of them are needed.
class IdleTakes {
 public:
  /// Before something is taken. @return whether the last object was not needed for long
  bool isSurplus(bool last_is_unused) {
    takes_ = last_is_unused ? takes_ + 1 : 0;
    return takes_ > kPatience;
  }

  /// The last object is taken, or is no longer the last.
  void restart() { takes_ = 0; }

 private:
  static constexpr int kPatience = 100;  // takes: some seconds
  int takes_ = 0;                        // in a row that did without the last object
};

}  // namespace rgbd_sfm_fusion
