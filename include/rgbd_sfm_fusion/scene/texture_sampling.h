// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Filtered look-up in a MipTexture: the inner loop of rendering.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <opencv2/core/hal/intrin.hpp>

#include "rgbd_sfm_fusion/scene/mip_texture.h"
#include "rgbd_sfm_fusion/scene/rasteriser.h"

namespace rgbd_sfm_fusion {

/// A pixel's outline in a texture, as samples along its long axis.
struct Footprint {
  float u, v;    ///< centre, 0 to 1
  float du, dv;  ///< from one sample to the next
  float taps;    ///< number of samples, whole
  float level;   ///< of the texture, continuous
};

/// The affine forms of a ProjectedPatch along a row, from some pixel on.
struct FootprintForms {
  float inverse_depth, inverse_depth_dx, inverse_depth_dy;
  float u, u_dx, u_dy;
  float v, v_dx, v_dy;
  float width, height;  ///< of the texture [texel]

  FootprintForms(const ProjectedPatch& p, const MipTexture& texture, double x, double y)
      : inverse_depth(static_cast<float>(p.inverse_depth.at(x, y))),
        inverse_depth_dx(static_cast<float>(p.inverse_depth.dx)),
        inverse_depth_dy(static_cast<float>(p.inverse_depth.dy)),
        u(static_cast<float>(p.u.at(x, y))),
        u_dx(static_cast<float>(p.u.dx)),
        u_dy(static_cast<float>(p.u.dy)),
        v(static_cast<float>(p.v.at(x, y))),
        v_dx(static_cast<float>(p.v.dx)),
        v_dy(static_cast<float>(p.v.dy)),
        width(static_cast<float>(texture.levels().front().width)),
        height(static_cast<float>(texture.levels().front().height)) {}
};

/// log2 to within 0.09, and continuous.
inline float roughLog2(float x) {
  std::int32_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  return static_cast<float>(bits) * (1.0f / 8388608.0f) - 126.957f;
}

/// @param step pixels to the right of where the forms start
inline Footprint footprintAt(const FootprintForms& f, float step) {
  constexpr float kMostTaps = 4.0f;
  // The lens is no better than that: footprints are this much longer than a pixel's side (log2).
  constexpr float kSoftness = 0.2f;
  const float z = 1.0f / (f.inverse_depth + f.inverse_depth_dx * step);
  const float u = (f.u + f.u_dx * step) * z, v = (f.v + f.v_dx * step) * z;
  const float ux = (f.u_dx - u * f.inverse_depth_dx) * z, vx = (f.v_dx - v * f.inverse_depth_dx) * z;
  const float uy = (f.u_dy - u * f.inverse_depth_dy) * z, vy = (f.v_dy - v * f.inverse_depth_dy) * z;
  const float w2 = f.width * f.width, h2 = f.height * f.height;
  const float along_x = ux * ux * w2 + vx * vx * h2 + 1e-12f, along_y = uy * uy * w2 + vy * vy * h2 + 1e-12f;
  const float longer = std::max(along_x, along_y), shorter = std::min(along_x, along_y);
  const float ratio = std::sqrt(longer / shorter);
  const float taps = static_cast<float>(static_cast<int>(std::min(ratio + 0.3f, kMostTaps)));
  const float per_tap = 1.0f / std::max(taps, 1.0f);
  const bool x_longer = along_x > along_y;
  return {u,
          v,
          (x_longer ? ux : uy) * per_tap,
          (x_longer ? vx : vy) * per_tap,
          std::max(taps, 1.0f),
          0.5f * roughLog2(longer * per_tap * per_tap) + kSoftness};
}

inline cv::v_float32x4 texel(const std::uint8_t* rgbx) {
  return cv::v_cvt_f32(cv::v_reinterpret_as_s32(cv::v_load_expand_q(rgbx)));
}

inline cv::v_float32x4 blend(const cv::v_float32x4& a, const cv::v_float32x4& b, float weight) {
  return cv::v_muladd(b - a, cv::v_setall_f32(weight), a);
}

inline cv::v_float32x4 bilinear(const MipTexture::Level& level, const std::uint8_t* texels, float u,
                                float v) {
  const float width = static_cast<float>(level.width), height = static_cast<float>(level.height);
  const float x = std::min(std::max(u * width - 0.5f, 0.0f), width - 1.001f);
  const float y = std::min(std::max(v * height - 0.5f, 0.0f), height - 1.001f);
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  const std::size_t stride = 4 * static_cast<std::size_t>(level.width);
  const std::uint8_t* here =
      texels + 4 * (level.offset + static_cast<std::size_t>(column)) + stride * static_cast<std::size_t>(row);
  const float right = x - static_cast<float>(column), down = y - static_cast<float>(row);
  return blend(blend(texel(here), texel(here + 4), right),
               blend(texel(here + stride), texel(here + stride + 4), right), down);
}

/// @return RGBX, 0 to 255
inline cv::v_float32x4 sampleTexture(const MipTexture& texture, const Footprint& f) {
  const auto& levels = texture.levels();
  const float level = std::min(std::max(f.level, 0.0f), static_cast<float>(levels.size() - 1) - 0.001f);
  const auto fine = static_cast<std::size_t>(level);
  const float coarser = level - static_cast<float>(fine);
  cv::v_float32x4 sum = cv::v_setzero_f32();
  float u = f.u - 0.5f * (f.taps - 1.0f) * f.du, v = f.v - 0.5f * (f.taps - 1.0f) * f.dv;
  for (int tap = static_cast<int>(f.taps); tap > 0; --tap, u += f.du, v += f.dv) {
    const cv::v_float32x4 colour = bilinear(levels[fine], texture.texels(), u, v);
    sum +=
        f.level <= 0.0f ? colour : blend(colour, bilinear(levels[fine + 1], texture.texels(), u, v), coarser);
  }
  return sum * cv::v_setall_f32(1.0f / f.taps);
}

inline void storeColour(const cv::v_float32x4& colour, std::uint8_t* rgbx) {
  const cv::v_int16x8 words = cv::v_pack(cv::v_round(colour), cv::v_round(colour));
  const std::uint32_t bytes = cv::v_reinterpret_as_u32(cv::v_pack_u(words, words)).get0();
  std::memcpy(rgbx, &bytes, sizeof bytes);
}

}  // namespace rgbd_sfm_fusion
