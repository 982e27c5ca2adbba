// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace rgbd_sfm_fusion {

/// Sorts numbers, without NaN, in ascending order. Of some thousand numbers without any order, std::sort
/// takes several times as long: the processor cannot predict what its comparisons give.
inline void radixSort(std::vector<float>* values) {
  constexpr std::uint32_t kBits = 11, kDigits = 3, kMask = (1u << kBits) - 1, kSign = 0x80000000u;
  std::vector<std::uint32_t> keys(values->size()), sorted(values->size());
  std::array<std::array<std::size_t, kMask + 1>, kDigits> places{};  // first how many keys have a digit
  for (std::size_t i = 0; i < keys.size(); ++i) {
    std::uint32_t bits;
    std::memcpy(&bits, &(*values)[i], sizeof(bits));
    keys[i] = (bits & kSign) != 0 ? ~bits : bits | kSign;  // in the order of the numbers
    for (std::uint32_t digit = 0; digit < kDigits; ++digit)
      ++places[digit][keys[i] >> (digit * kBits) & kMask];
  }
  for (std::uint32_t digit = 0; digit < kDigits; ++digit) {
    std::size_t before = 0;
    for (std::size_t& place : places[digit]) {
      const std::size_t count = place;
      place = before;
      before += count;
    }
    for (const std::uint32_t key : keys) sorted[places[digit][key >> (digit * kBits) & kMask]++] = key;
    keys.swap(sorted);
  }
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const std::uint32_t bits = (keys[i] & kSign) != 0 ? keys[i] ^ kSign : ~keys[i];
    std::memcpy(&(*values)[i], &bits, sizeof(bits));
  }
}

}  // namespace rgbd_sfm_fusion
