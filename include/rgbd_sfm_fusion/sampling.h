// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Bilinear samples of an image, for a block of kLanes positions. Call it from vector code (multiversion.h),
/// into which it is inlined. With SSE2, one load takes a pixel and the one beside it. AVX2's gathers were no
/// gain (docs/performance.md). The code without SSE2 gives the same bits.
#pragma once

#include <cstdint>
#include <cstring>

#include "rgbd_sfm_fusion/simd.h"

#if defined(__SSE2__) && defined(__GNUC__)
#define RGBD_SFM_FUSION_SSE2
#include <emmintrin.h>
#endif

namespace rgbd_sfm_fusion {

#ifdef RGBD_SFM_FUSION_SSE2

namespace sampling {

constexpr int kFour = 4;

/// The values of four pixels, and of the pixels to their right.
struct Pairs {
  __m128 left, right;
};

/// @param distance  from the places to the pixels that are loaded
inline Pairs load(const float* const (&places)[kFour], int distance) {
  const auto pair = [&](int i) { return reinterpret_cast<const __m64*>(places[i] + distance); };
  const __m128 nothing = _mm_setzero_ps();
  const __m128 first = _mm_loadh_pi(_mm_loadl_pi(nothing, pair(0)), pair(1));
  const __m128 second = _mm_loadh_pi(_mm_loadl_pi(nothing, pair(2)), pair(3));
  return {_mm_shuffle_ps(first, second, 0x88), _mm_shuffle_ps(first, second, 0xDD)};
}

inline Pairs load(const std::uint8_t* const (&places)[kFour], int distance) {
  const auto pair = [&](int i) {
    std::uint16_t two;
    std::memcpy(&two, places[i] + distance, sizeof(two));
    return static_cast<int>(two);
  };
  __m128i pairs = _mm_cvtsi32_si128(pair(0));
  pairs = _mm_insert_epi16(pairs, pair(1), 2);
  pairs = _mm_insert_epi16(pairs, pair(2), 4);
  pairs = _mm_insert_epi16(pairs, pair(3), 6);
  return {_mm_cvtepi32_ps(_mm_and_si128(pairs, _mm_set1_epi32(0xFF))),
          _mm_cvtepi32_ps(_mm_srli_epi32(pairs, 8))};
}

inline __m128 fractionOf(__m128 position) {
  return _mm_sub_ps(position, _mm_cvtepi32_ps(_mm_cvttps_epi32(position)));
}

inline __m128 between(__m128 from, __m128 to, __m128 fraction) {
  return _mm_add_ps(from, _mm_mul_ps(fraction, _mm_sub_ps(to, from)));
}

}  // namespace sampling

/// @param image   of floats, or of bytes, which need a quarter of the cache
/// @param stride  [values] from a row to the next
/// @param u, v    kLanes positions within [0, width - 1) x [0, height - 1)
/// @param values  kLanes of them
template <class Value>
__attribute__((always_inline)) inline void sampleBlock(const Value* image, int stride, const float* u,
                                                       const float* v, float* values) {
  using sampling::kFour;
  int place[kLanes];
  for (int l = 0; l < kLanes; ++l) place[l] = static_cast<int>(v[l]) * stride + static_cast<int>(u[l]);
  for (int l = 0; l < kLanes; l += kFour) {
    const Value* const places[kFour] = {image + place[l], image + place[l + 1], image + place[l + 2],
                                        image + place[l + 3]};
    const sampling::Pairs above = sampling::load(places, 0), below = sampling::load(places, stride);
    const __m128 fraction_u = sampling::fractionOf(_mm_loadu_ps(u + l));
    const __m128 fraction_v = sampling::fractionOf(_mm_loadu_ps(v + l));
    const __m128 top = sampling::between(above.left, above.right, fraction_u);
    const __m128 bottom = sampling::between(below.left, below.right, fraction_u);
    _mm_storeu_ps(values + l, sampling::between(top, bottom, fraction_v));
  }
}

#else

template <class Value>
inline void sampleBlock(const Value* image, int stride, const float* u, const float* v, float* values) {
  for (int l = 0; l < kLanes; ++l) {
    const int column = static_cast<int>(u[l]), row = static_cast<int>(v[l]);
    const float fraction_u = u[l] - static_cast<float>(column), fraction_v = v[l] - static_cast<float>(row);
    const Value* pixel = image + row * stride + column;
    const auto at = [pixel](int place) { return static_cast<float>(pixel[place]); };
    const float top = at(0) + fraction_u * (at(1) - at(0));
    const float bottom = at(stride) + fraction_u * (at(stride + 1) - at(stride));
    values[l] = top + fraction_v * (bottom - top);
  }
}

#endif

}  // namespace rgbd_sfm_fusion
