// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A mark for functions with loops over raw pointers that call inline functions only. Such a function is
/// compiled twice, for AVX2 and for any x86-64, and one of the two is chosen when the library is loaded. AVX2
/// is used without FMA, so that both give the same bits. Under sanitizers the mark is empty: their run-times
/// do not survive the choice.
#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define RGBD_SFM_FUSION_MULTIVERSION __attribute__((target_clones("avx2", "default")))
#else
#define RGBD_SFM_FUSION_MULTIVERSION
#endif
