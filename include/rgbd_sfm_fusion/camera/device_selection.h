// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace rgbd_sfm_fusion {

/// A device to try, and whether it is the one only if its serial number says so.
struct DeviceCandidate {
  std::string uri;
  bool check_serial = false;
};

/// Devices that `selector` may mean, the likeliest first.
/// @param selector  empty: any; "#2": the second of `uris`; a URI, or a serial number
/// @param uris      of the devices that are plugged in
/// @return none where the index is no number, or has no device
std::vector<DeviceCandidate> selectDevices(const std::string& selector, const std::vector<std::string>& uris);

/// For error messages: "none" or the URIs.
std::string listUris(const std::vector<std::string>& uris);

}  // namespace rgbd_sfm_fusion
