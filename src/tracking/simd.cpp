// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/simd.h"

#if defined(__x86_64__) && defined(__GNUC__)
#define RGBD_SFM_FUSION_X86
#include <immintrin.h>
#endif

namespace rgbd_sfm_fusion {
namespace {

void samplePlainly(const float* image, int stride, const float* u, const float* v, float* values) {
  for (int l = 0; l < kLanes; ++l) {
    const int column = static_cast<int>(u[l]), row = static_cast<int>(v[l]);
    const float fraction_u = u[l] - static_cast<float>(column), fraction_v = v[l] - static_cast<float>(row);
    const float* pixel = image + row * stride + column;
    const float top = pixel[0] + fraction_u * (pixel[1] - pixel[0]);
    const float bottom = pixel[stride] + fraction_u * (pixel[stride + 1] - pixel[stride]);
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

// Written by hand: compilers do not use gathers, which make this three times as fast.
__attribute__((target("avx2"))) void sampleWithGathers(const float* image, int stride, const float* u,
                                                       const float* v, float* values) {
  const __m256i row_length = _mm256_set1_epi32(stride);
  for (int l = 0; l < kLanes; l += 8) {
    const __m256 x = _mm256_loadu_ps(u + l), y = _mm256_loadu_ps(v + l);
    const __m256i column = _mm256_cvttps_epi32(x), row = _mm256_cvttps_epi32(y);
    const __m256 fraction_u = _mm256_sub_ps(x, _mm256_cvtepi32_ps(column));
    const __m256 fraction_v = _mm256_sub_ps(y, _mm256_cvtepi32_ps(row));
    const __m256i place = _mm256_add_epi32(_mm256_mullo_epi32(row, row_length), column);
    const __m256i halves = _mm256_permute4x64_epi64(place, 0xD8);
    const __m128i four = _mm256_castsi256_si128(halves), other_four = _mm256_extracti128_si256(halves, 1);
    const Pairs above = gatherPairs(image, four, other_four);
    const Pairs below = gatherPairs(image + stride, four, other_four);
    const __m256 top =
        _mm256_add_ps(above.left, _mm256_mul_ps(fraction_u, _mm256_sub_ps(above.right, above.left)));
    const __m256 bottom =
        _mm256_add_ps(below.left, _mm256_mul_ps(fraction_u, _mm256_sub_ps(below.right, below.left)));
    _mm256_storeu_ps(values + l, _mm256_add_ps(top, _mm256_mul_ps(fraction_v, _mm256_sub_ps(bottom, top))));
  }
}

#endif

}  // namespace

SampleBlock sampleBlock() {
#ifdef RGBD_SFM_FUSION_X86
  static const bool has_gathers = __builtin_cpu_supports("avx2") != 0;
  if (has_gathers) return sampleWithGathers;
#endif
  return samplePlainly;
}

}  // namespace rgbd_sfm_fusion
