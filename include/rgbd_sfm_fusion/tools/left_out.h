// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Messages that cannot be used, by topic. The first one of each topic is reported at once, their number at
/// the end.
class LeftOutMessages {
 public:
  explicit LeftOutMessages(std::function<void(const std::string&)> say) : say_(std::move(say)) {}

  /// @param time  the message's stamp; if it cannot be read, the time of recording
  void add(const std::string& topic, Stamp time, const std::string& reason);

  std::size_t count(const std::string& topic) const;

  /// A line for each topic with more than one such message: how many, from when to when.
  std::vector<std::string> summary() const;

 private:
  struct Found {
    std::size_t count = 0;
    Stamp first = kNoStamp;
    Stamp last = kNoStamp;
  };

  std::function<void(const std::string&)> say_;
  std::map<std::string, Found> found_;
};

}  // namespace rgbd_sfm_fusion
