// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tools/left_out.h"

#include "rgbd_sfm_fusion/tools/text_format.h"

namespace rgbd_sfm_fusion {

void LeftOutMessages::add(const std::string& topic, Stamp time, const std::string& reason) {
  Found& found = found_[topic];
  if (found.count == 0) {
    found.first = time;
    say_(topic + ": the message of " + formatStamp(time) + " s is left out: " + reason);
  }
  if (found.count > 0 && found.last == time) return;  // one depth image may serve two colour images
  found.last = time;
  ++found.count;
}

std::size_t LeftOutMessages::count(const std::string& topic) const {
  const auto found = found_.find(topic);
  return found == found_.end() ? 0 : found->second.count;
}

std::vector<std::string> LeftOutMessages::summary() const {
  std::vector<std::string> lines;
  for (const auto& [topic, found] : found_) {
    if (found.count > 1)
      lines.push_back(topic + ": " + std::to_string(found.count) + " messages could not be used, from " +
                      formatStamp(found.first) + " to " + formatStamp(found.last) + " s");
  }
  return lines;
}

}  // namespace rgbd_sfm_fusion
