// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Filtered look-up in a MipTexture: the inner loop of rendering. Pixels are handled in blocks of kBlock
/// neighbours of the same surface, which share their texture levels and their number of samples, so that
/// compilers can turn the loops over a block into vector code.
#pragma once

#include <cstdint>
#include <cstring>

#include "rgbd_sfm_fusion/scene/mip_texture.h"
#include "rgbd_sfm_fusion/scene/rasteriser.h"

namespace rgbd_sfm_fusion {

constexpr int kBlock = 16;  ///< [px]

/// The affine forms of a ProjectedPatch along a row, beginning at some pixel. u and v count texels of the
/// largest level.
struct RowForms {
  float inverse_depth, inverse_depth_dx, inverse_depth_dy;
  float u, u_dx, u_dy;
  float v, v_dx, v_dy;

  RowForms(const ProjectedPatch& p, const MipTexture& texture, double x, double y)
      : inverse_depth(static_cast<float>(p.inverse_depth.at(x, y))),
        inverse_depth_dx(static_cast<float>(p.inverse_depth.dx)),
        inverse_depth_dy(static_cast<float>(p.inverse_depth.dy)) {
    const double width = texture.levels().front().width, height = texture.levels().front().height;
    u = static_cast<float>(width * p.u.at(x, y));
    u_dx = static_cast<float>(width * p.u.dx);
    u_dy = static_cast<float>(width * p.u.dy);
    v = static_cast<float>(height * p.v.at(x, y));
    v_dx = static_cast<float>(height * p.v.dx);
    v_dy = static_cast<float>(height * p.v.dy);
  }
};

/// A pixel's outline in its texture, in texels of the largest level.
struct Footprint {
  float u, v;             ///< centre
  float du, dv;           ///< along its longer side
  float longer_squared;   ///< squared length of the longer side
  float shorter_squared;  ///< squared length of the shorter side
};

/// @param step pixels to the right of where the forms start
inline Footprint footprintAt(const RowForms& f, float step) {
  const float z = 1.0f / (f.inverse_depth + f.inverse_depth_dx * step);
  const float u = (f.u + f.u_dx * step) * z, v = (f.v + f.v_dx * step) * z;
  const float ux = (f.u_dx - u * f.inverse_depth_dx) * z, vx = (f.v_dx - v * f.inverse_depth_dx) * z;
  const float uy = (f.u_dy - u * f.inverse_depth_dy) * z, vy = (f.v_dy - v * f.inverse_depth_dy) * z;
  const float along_x = ux * ux + vx * vx, along_y = uy * uy + vy * vy;
  const bool x_longer = along_x > along_y;
  return {u,
          v,
          x_longer ? ux : uy,
          x_longer ? vx : vy,
          x_longer ? along_x : along_y,
          x_longer ? along_y : along_x};
}

/// How many samples make a footprint nearly round. If it is more than 2, 3 or 4 times as long as wide, it
/// takes 2, 3 or 4.
inline int tapsFor(const Footprint& f) {
  const float slant_squared = f.longer_squared / (f.shorter_squared + 1e-12f);
  return 1 + (slant_squared > 4.0f) + (slant_squared > 9.0f) + (slant_squared > 16.0f);
}

/// Level of the texture whose texels are as large as a footprint that is covered by `taps` samples.
inline float levelFor(float longer_squared, float taps) {
  // The lens blurs: footprints are longer than a pixel's side by this much (log2).
  constexpr float kSoftness = 0.2f;
  const float squared = longer_squared / (taps * taps) + 1e-12f;
  std::int32_t bits;
  std::memcpy(&bits, &squared, sizeof bits);
  // log2 to within 0.09, and continuous: exponent and mantissa of a float as one number.
  return 0.5f * (static_cast<float>(bits) * (1.0f / 8388608.0f) - 126.957f) + kSoftness;
}

/// Limits a coordinate; NaN, which pixels beyond the horizon have, becomes 0.
inline float limited(float x, float most) {
  const float positive = x > 0.0f ? x : 0.0f;
  return positive < most ? positive : most;
}

/// The upper left one of four texels of a level, and the weights of all four.
struct WeightedTexels {
  std::int32_t index;
  std::uint32_t upper_left, upper_right, lower_left, lower_right;
};

/// The bilinear weights of a point between four texels, in whole numbers.
/// @param u,v             [texel] of the largest level
/// @param scale_x,scale_y texels of the level per texel of the largest level
/// @param most_x,most_y   [texel] of the level: its last point with four texels around it
/// @param whole           what the weights add up to, at most 2^13
inline WeightedTexels weightedTexels(float u, float v, float scale_x, float scale_y, int width, float most_x,
                                     float most_y, std::int32_t whole) {
  constexpr int kBits = 8;  // of positions between texels
  const auto x = static_cast<std::int32_t>((1 << kBits) * limited(u * scale_x - 0.5f, most_x));
  const auto y = static_cast<std::int32_t>((1 << kBits) * limited(v * scale_y - 0.5f, most_y));
  constexpr std::int32_t kFraction = (1 << kBits) - 1;
  const std::int32_t right = (whole * (x & kFraction)) >> kBits, down = (whole * (y & kFraction)) >> kBits;
  // At most `right` and `down`, so no weight is negative.
  const std::int32_t both = (right * (y & kFraction)) >> kBits;
  return {(y >> kBits) * width + (x >> kBits), static_cast<std::uint32_t>(whole - right - down + both),
          static_cast<std::uint32_t>(right - both), static_cast<std::uint32_t>(down - both),
          static_cast<std::uint32_t>(both)};
}

}  // namespace rgbd_sfm_fusion
