// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Normal equations of many residuals, for vector code (multiversion.h), into which this is inlined.
#pragma once

#include <cstddef>

#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {

/// So many blocks are weighed before they are added up, so that each sum is loaded and stored once for all of
/// them.
constexpr int kTile = 4;

/// Residuals of the blocks of a tile, with their weights and their derivatives by each parameter.
template <int kParameters>
struct EquationTile {
  float weight[kTile][kLanes], residual[kTile][kLanes];
  float J[static_cast<std::size_t>(kParameters)][kTile][kLanes];
};

/// Sums over residuals, per lane: the upper triangle of Jᵀ W J, row by row, and Jᵀ W r.
template <int kParameters>
struct EquationSums {
  float hessian[static_cast<std::size_t>(kParameters * (kParameters + 1) / 2)][kLanes];
  float gradient[static_cast<std::size_t>(kParameters)][kLanes];
};

/// Adds the blocks of a tile to the sums, one block after the other.
template <int kParameters>
__attribute__((always_inline)) inline void add(const EquationTile<kParameters>& tile,
                                               EquationSums<kParameters>& __restrict sums) {
  int term = 0;
  for (int i = 0; i < kParameters; ++i) {
    float weighted[kTile][kLanes];
    for (int b = 0; b < kTile; ++b) {
      for (int l = 0; l < kLanes; ++l) weighted[b][l] = tile.weight[b][l] * tile.J[i][b][l];
    }
    for (int b = 0; b < kTile; ++b) {
      for (int l = 0; l < kLanes; ++l) sums.gradient[i][l] += weighted[b][l] * tile.residual[b][l];
    }
    for (int j = i; j < kParameters; ++j, ++term) {
      for (int b = 0; b < kTile; ++b) {
        for (int l = 0; l < kLanes; ++l) sums.hessian[term][l] += weighted[b][l] * tile.J[j][b][l];
      }
    }
  }
}

inline double total(const float (&lanes)[kLanes]) {
  double sum = 0.0;
  for (const float lane : lanes) sum += static_cast<double>(lane);
  return sum;
}

/// Adds up the lanes.
/// @param H, g  overwritten
template <int kParameters, class Matrix, class Vector>
void addUp(const EquationSums<kParameters>& sums, Matrix& H, Vector& g) {
  int term = 0;
  for (int i = 0; i < kParameters; ++i) {
    g(i) = total(sums.gradient[i]);
    for (int j = i; j < kParameters; ++j, ++term) H(i, j) = H(j, i) = total(sums.hessian[term]);
  }
}

}  // namespace rgbd_sfm_fusion
