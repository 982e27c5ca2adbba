// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/camera/device_selection.h"

#include <algorithm>
#include <cstddef>

namespace rgbd_sfm_fusion {
namespace {

/// @return 0 when `selector` is no index
std::size_t parseIndex(const std::string& selector) {
  const bool is_index =
      selector.size() > 1 && selector.size() < 6 && selector[0] == '#' &&
      std::all_of(selector.begin() + 1, selector.end(), [](char c) { return c >= '0' && c <= '9'; });
  return is_index ? std::stoul(selector.substr(1)) : 0;
}

}  // namespace

std::vector<DeviceCandidate> selectDevices(const std::string& selector,
                                           const std::vector<std::string>& uris) {
  if (selector.empty() || selector[0] == '#') {
    const std::size_t index = selector.empty() ? 1 : parseIndex(selector);
    if (index == 0 || index > uris.size()) return {};
    return {{uris[index - 1], false}};
  }
  if (std::find(uris.begin(), uris.end(), selector) != uris.end()) return {{selector, false}};
  std::vector<DeviceCandidate> candidates;
  candidates.reserve(uris.size() + 1);
  for (const std::string& uri : uris) candidates.push_back({uri, true});
  candidates.push_back({selector, false});  // drivers open more than they list, e.g. a recording's path
  return candidates;
}

std::string listUris(const std::vector<std::string>& uris) {
  std::string text;
  for (const std::string& uri : uris) text += (text.empty() ? "" : ", ") + uri;
  return text.empty() ? "none" : text;
}

}  // namespace rgbd_sfm_fusion
