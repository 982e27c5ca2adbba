// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace rgbd_sfm_fusion {

/// A device to try. Some are wanted only if they turn out to have the right serial number.
struct DeviceCandidate {
  std::string uri;
  bool check_serial = false;
};

/// Devices that `selector` may mean, the most likely one first.
/// @param selector  empty: any; "#2": the second of `uris`; a URI, or a serial number
/// @param uris      of the devices that are plugged in
/// @return empty if the index is no number, or there is no such device
std::vector<DeviceCandidate> selectDevices(const std::string& selector, const std::vector<std::string>& uris);

/// For error messages: "none" or the URIs.
std::string listUris(const std::vector<std::string>& uris);

}  // namespace rgbd_sfm_fusion
