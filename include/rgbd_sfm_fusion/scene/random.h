// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace rgbd_sfm_fusion {

/// A hash of 32 bits in which every input bit changes about half of the output bits ("lowbias32" constants
/// of the hash-prospector project, public domain).
constexpr std::uint32_t mixBits(std::uint32_t h) {
  h ^= h >> 16;
  h *= 0x7feb352dU;
  h ^= h >> 15;
  h *= 0x846ca68bU;
  return h ^ (h >> 16);
}

/// Random numbers without a state: number `counter` of a stream is always the same, whatever was asked for
/// before, and on whatever thread. There are two keys, so that one stream is not a shifted copy of another.
class CounterRandom {
 public:
  constexpr CounterRandom(std::uint64_t seed, std::uint32_t frame, std::uint32_t stream)
      : first_key_(mixBits(mixBits(static_cast<std::uint32_t>(seed) + stream * 0x9e3779b9U) + frame)),
        second_key_(mixBits(first_key_ ^ mixBits(static_cast<std::uint32_t>(seed >> 32) + ~stream))) {}

  constexpr std::uint32_t bits(std::uint32_t counter) const {
    std::uint32_t h = counter * 0x9e3779b9U + first_key_;
    h ^= h >> 16;
    h *= 0x7feb352dU;
    h ^= second_key_ ^ (h >> 15);
    h *= 0x846ca68bU;
    return h ^ (h >> 16);
  }

  /// In [0, 1).
  constexpr float uniform(std::uint32_t counter) const {
    return static_cast<float>(bits(counter) >> 8) * (1.0f / 16777216.0f);
  }

  static constexpr int kSumMean = 30;
  static constexpr float kSumSigma = 9.2195445f;

  /// Two independent sums of four numbers from 0 to 15, in the lower and the upper 16 bits. Each is nearly
  /// Gaussian within its bounds of 3.25 sigma. This takes a few additions; the method of Box and Muller takes
  /// a logarithm and a cosine.
  constexpr std::uint32_t twoSums(std::uint32_t counter) const {
    const std::uint32_t h = bits(counter);
    const std::uint32_t pairs = (h & 0x0f0f0f0fU) + ((h >> 4) & 0x0f0f0f0fU);
    return (pairs & 0x00ff00ffU) + ((pairs >> 8) & 0x00ff00ffU);
  }

 private:
  std::uint32_t first_key_;
  std::uint32_t second_key_;
};

}  // namespace rgbd_sfm_fusion
