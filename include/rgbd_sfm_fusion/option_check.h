// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

#include "rgbd_sfm_fusion/tools/number_text.h"

namespace rgbd_sfm_fusion {

/// @param option  the option's name as users know it: the name of its setting, if there is one
/// @throws std::invalid_argument naming the option, its value and the range, unless low <= value <= high
///         (so NaN is out of any range)
template <typename T>
void requireInRange(const char* option, T value, T low, T high) {
  if (value >= low && value <= high) return;
  throw std::invalid_argument(std::string(option) + " = " + numberText(value) + ": expected " +
                              numberText(low) + " to " + numberText(high));
}

}  // namespace rgbd_sfm_fusion
