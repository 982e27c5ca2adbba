// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

namespace rgbd_sfm_fusion {

/// Decides which sentences about unmet conditions deserve a line in the log: those that are new, or were last
/// said two minutes ago. Sentences that differ only in their numbers count as the same.
class ConditionReport {
 public:
  /// @param time  [s] on any clock that does not go back
  std::vector<std::string> worthSaying(double time, const std::vector<std::string>& sentences);

 private:
  std::map<std::string, double> said_;  ///< [s] by sentence without its numbers; of those that hold
};

}  // namespace rgbd_sfm_fusion
