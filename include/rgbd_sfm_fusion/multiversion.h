// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Before loops over raw pointers that call inline functions only: compiled for AVX2 and for any x86-64,
/// chosen when the library is loaded. AVX2 without FMA, so that both give the same bits. Sanitizers'
/// run-times do not survive the choice.
#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define RGBD_SFM_FUSION_MULTIVERSION __attribute__((target_clones("avx2", "default")))
#else
#define RGBD_SFM_FUSION_MULTIVERSION
#endif
