// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace rgbd_sfm_fusion {

/// Ratio of a Gaussian's σ to the median of its absolute values.
constexpr double kSigmaOfMedian = 1.4826;

/// The median; of an even number of values, the upper one of the two in the middle. Reorders the values.
/// @param values  at least one
template <typename Value>
Value median(std::vector<Value>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

template <typename Value>
Value median(std::vector<Value>&& values) {
  return median(values);
}

}  // namespace rgbd_sfm_fusion
