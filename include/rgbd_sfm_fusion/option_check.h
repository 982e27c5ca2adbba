// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sstream>
#include <stdexcept>

namespace rgbd_sfm_fusion {

/// @throws std::invalid_argument naming the option, its value and the range, unless low <= value <= high
///         (so NaN is out of any range)
template <typename T>
void requireInRange(const char* option, T value, T low, T high) {
  if (value >= low && value <= high) return;
  std::ostringstream message;
  message << option << " = " << value << ": must be in [" << low << ", " << high << "]";
  throw std::invalid_argument(message.str());
}

}  // namespace rgbd_sfm_fusion
