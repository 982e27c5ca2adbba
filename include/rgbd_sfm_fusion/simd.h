// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Hot loops are written over blocks of kLanes values, one array per quantity, which compilers turn into
/// vector code. Sums are kept per lane and added up in a fixed order, and products and sums are not
/// contracted (-ffp-contract=off), so that every vector width gives the same bits.
#pragma once

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {

/// Values that a hot loop handles side by side: two AVX or four SSE registers of floats.
constexpr int kLanes = 16;

/// `count` rounded up to full blocks.
constexpr int paddedToLanes(int count) {
  return (count + kLanes - 1) / kLanes * kLanes;
}

/// As std::min and std::max, but of values, which compilers turn into vector code.
inline float lesser(float a, float b) {
  return a < b ? a : b;
}
inline float greater(float a, float b) {
  return a > b ? a : b;
}

/// Bilinear values of an image with rows of length `stride`, for a block of positions within
/// [0, width - 1) x [0, height - 1).
using SampleBlock = void (*)(const float* image, int stride, const float* u, const float* v, float* values);

/// The fastest that this processor has; all give the same bits.
SampleBlock sampleBlock();

}  // namespace rgbd_sfm_fusion
