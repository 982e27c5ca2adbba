// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Hot loops are written over blocks of kLanes values, one array per quantity, which compilers turn into
/// vector code. Sums are kept per lane and added up in a fixed order, and products and sums are not
/// contracted (-ffp-contract=off), so that every vector width gives the same bits.
#pragma once

/// Compiles a leaf function twice, and lets the loader choose by what the processor has. (Sanitizers start
/// after the loader's choice would run, so they get one version.)
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define RGBD_SFM_FUSION_MULTIVERSION __attribute__((target_clones("arch=haswell", "default")))
#else
#define RGBD_SFM_FUSION_MULTIVERSION
#endif

namespace rgbd_sfm_fusion {

/// Values that a hot loop handles side by side: two AVX or four SSE registers of floats.
constexpr int kLanes = 16;

/// `count` rounded up to full blocks.
constexpr int paddedToLanes(int count) { return (count + kLanes - 1) / kLanes * kLanes; }

}  // namespace rgbd_sfm_fusion
