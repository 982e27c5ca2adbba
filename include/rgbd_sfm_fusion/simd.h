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

/// Values that a hot loop handles side by side: two AVX or four SSE registers of floats.
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

/// Bilinear values of an image with rows of length `stride`, for a block of positions within
/// [0, width - 1) x [0, height - 1).
using SampleBlock = void (*)(const float* image, int stride, const float* u, const float* v, float* values);

/// The fastest SampleBlock for this processor. All of them give the same bits.
SampleBlock sampleBlock();

/// The same for whole grey levels, which need a quarter of the cache. Positions are within
/// [2, width - 1) x [0, height - 1), or [0, width - 1) x [1, height - 1).
using SampleGreyBlock = void (*)(const std::uint8_t* image, int stride, const float* u, const float* v,
                                 float* values);
SampleGreyBlock sampleGreyBlock();

}  // namespace rgbd_sfm_fusion
