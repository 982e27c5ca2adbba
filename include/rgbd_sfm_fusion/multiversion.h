// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A mark for functions with loops over raw pointers that call inline functions only. Such a function is
/// compiled for AVX-512 (from GCC 12 on), for AVX2 and for any x86-64, and one of them is chosen when the
/// library is loaded. None uses FMA, so that all give the same bits. Under sanitizers the mark is empty:
/// their run-times do not survive the choice.
#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#if __GNUC__ >= 12
#define RGBD_SFM_FUSION_MULTIVERSION __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#else
#define RGBD_SFM_FUSION_MULTIVERSION __attribute__((target_clones("avx2", "default")))
#endif
#else
#define RGBD_SFM_FUSION_MULTIVERSION
#endif
