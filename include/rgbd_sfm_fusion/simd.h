// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Hot loops go over blocks of kLanes values, with one array per quantity. Compilers turn such loops into
/// vector code. Every vector width gives the same bits: sums are kept per lane and added up in a fixed order,
/// and products and sums are not contracted (-ffp-contract=off).
#pragma once

#include <cstdint>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {

/// Values that a hot loop handles side by side: one AVX-512, two AVX or four SSE registers
/// of floats.
constexpr int kLanes = 16;

/// `count` rounded up to full blocks.
constexpr int paddedToLanes(int count) {
  return (count + kLanes - 1) / kLanes * kLanes;
}

/// Like std::min and std::max, but with values instead of references: compilers turn such calls into vector
/// code.
inline float lesser(float a, float b) {
  return a < b ? a : b;
}
inline float greater(float a, float b) {
  return a > b ? a : b;
}

/// Loads a block, of which `count` values exist: the last one stands for what is missing. Blocks are full but
/// for the last one of a row, and a full block is a plain load. Loops over values of one size are the
/// quickest, so bytes are loaded as int.
template <typename From, typename To>
inline void load(const From* from, int count, To* to) {
  if (count == kLanes) {
    for (int i = 0; i < kLanes; ++i) to[i] = static_cast<To>(from[i]);
  } else {
    for (int i = 0; i < kLanes; ++i) to[i] = static_cast<To>(from[i < count ? i : count - 1]);
  }
}

/// Stores the values of a block that exist.
inline void store(const float* from, int count, float* to) {
  if (count == kLanes) {
    for (int i = 0; i < kLanes; ++i) to[i] = from[i];
  } else {
    for (int i = 0; i < count; ++i) to[i] = from[i];
  }
}

/// Whether none of `count` values is marked.
inline bool hasNone(const std::uint8_t* marks, int count) {
  int any = 0;
  for (int i = 0; i < count; ++i) any |= marks[i];
  return any == 0;
}

}  // namespace rgbd_sfm_fusion
