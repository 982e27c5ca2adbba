// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/simd.h"

#if defined(__x86_64__) && defined(__GNUC__)
#define RGBD_SFM_FUSION_X86
#include <immintrin.h>
#endif

namespace rgbd_sfm_fusion {
namespace {

template <class Value>
void samplePlainly(const Value* image, int stride, const float* u, const float* v, float* values) {
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

#ifdef RGBD_SFM_FUSION_X86

/// The values at eight places of an image, and the values beside them.
struct Pairs {
  __m256 left, right;
};

/// @param four, other_four  places 0, 1, 4, 5 and 2, 3, 6, 7: so that the halves come together in order
__attribute__((target("avx2"))) inline Pairs gatherPairs(const float* image, __m128i four,
                                                         __m128i other_four) {
  // One load takes both values. It has a mask, as compilers warn that the plain intrinsic uses undefined
  // values.
  const auto* const pairs = reinterpret_cast<const double*>(image);
  const __m256d nothing = _mm256_setzero_pd(), all = _mm256_castsi256_pd(_mm256_set1_epi64x(-1));
  const __m256 a = _mm256_castpd_ps(_mm256_mask_i32gather_pd(nothing, pairs, four, all, 4));
  const __m256 b = _mm256_castpd_ps(_mm256_mask_i32gather_pd(nothing, pairs, other_four, all, 4));
  return {_mm256_shuffle_ps(a, b, 0x88), _mm256_shuffle_ps(a, b, 0xDD)};
}

__attribute__((target("avx2"))) inline Pairs gatherPairs(const float* image, __m256i places) {
  const __m256i halves = _mm256_permute4x64_epi64(places, 0xD8);
  return gatherPairs(image, _mm256_castsi256_si128(halves), _mm256_extracti128_si256(halves, 1));
}

/// One load takes the two bytes before a place, and then the values.
__attribute__((target("avx2"))) inline Pairs gatherPairs(const std::uint8_t* image, __m256i places) {
  const __m256i all = _mm256_set1_epi32(-1);
  const __m256i bytes = _mm256_mask_i32gather_epi32(_mm256_setzero_si256(),
                                                    reinterpret_cast<const int*>(image - 2), places, all, 1);
  const __m256i left = _mm256_and_si256(_mm256_srli_epi32(bytes, 16), _mm256_set1_epi32(0xFF));
  return {_mm256_cvtepi32_ps(left), _mm256_cvtepi32_ps(_mm256_srli_epi32(bytes, 24))};
}

// Written by hand: compilers do not use gathers, which make this three times as fast.
template <class Value>
__attribute__((target("avx2"))) void sampleWithGathers(const Value* image, int stride, const float* u,
                                                       const float* v, float* values) {
  const __m256i row_length = _mm256_set1_epi32(stride);
  for (int l = 0; l < kLanes; l += 8) {
    const __m256 x = _mm256_loadu_ps(u + l), y = _mm256_loadu_ps(v + l);
    const __m256i column = _mm256_cvttps_epi32(x), row = _mm256_cvttps_epi32(y);
    const __m256 fraction_u = _mm256_sub_ps(x, _mm256_cvtepi32_ps(column));
    const __m256 fraction_v = _mm256_sub_ps(y, _mm256_cvtepi32_ps(row));
    const __m256i places = _mm256_add_epi32(_mm256_mullo_epi32(row, row_length), column);
    const Pairs above = gatherPairs(image, places);
    const Pairs below = gatherPairs(image + stride, places);
    const __m256 top =
        _mm256_add_ps(above.left, _mm256_mul_ps(fraction_u, _mm256_sub_ps(above.right, above.left)));
    const __m256 bottom =
        _mm256_add_ps(below.left, _mm256_mul_ps(fraction_u, _mm256_sub_ps(below.right, below.left)));
    _mm256_storeu_ps(values + l, _mm256_add_ps(top, _mm256_mul_ps(fraction_v, _mm256_sub_ps(bottom, top))));
  }
}

#endif

template <class Value>
auto sampling() -> void (*)(const Value*, int, const float*, const float*, float*) {
#ifdef RGBD_SFM_FUSION_X86
  static const bool has_gathers = __builtin_cpu_supports("avx2") != 0;
  if (has_gathers) return sampleWithGathers<Value>;
#endif
  return samplePlainly<Value>;
}

}  // namespace

SampleBlock sampleBlock() {
  return sampling<float>();
}

SampleGreyBlock sampleGreyBlock() {
  return sampling<std::uint8_t>();
}

}  // namespace rgbd_sfm_fusion
