// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace rgbd_sfm_fusion {

/// Index of the next place in a row that has this value, from `first` on; `width` if there is no such place.
/// Meant for rare values, as the C library skips many other values at once.
inline int findByte(std::uint8_t value, const std::uint8_t* row, int first, int width) {
  const void* found = std::memchr(row + first, value, static_cast<std::size_t>(width - first));
  return found == nullptr ? width : static_cast<int>(static_cast<const std::uint8_t*>(found) - row);
}

}  // namespace rgbd_sfm_fusion
