// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/scene/shader.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "outline.h"
#include "rgbd_sfm_fusion/multiversion.h"
#include "texture_sampling.h"

namespace rgbd_sfm_fusion {
namespace {

/// Numbers of the pixels of a block.
struct Block {
  float u[kBlock], v[kBlock], du[kBlock], dv[kBlock], longer_squared[kBlock];
  float weight[kBlock];
  std::int32_t index[kBlock];
  float right[kBlock], down[kBlock];
  std::uint32_t upper[kBlock][2], lower[kBlock][2];
  float red[kBlock], green[kBlock], blue[kBlock];
};

RGBD_SFM_FUSION_MULTIVERSION
void findFootprints(const RowForms& forms, float first_step, Block& block) {
  const RowForms f = forms;
  for (int i = 0; i < kBlock; ++i) {
    const Footprint footprint = footprintAt(f, first_step + static_cast<float>(i));
    block.u[i] = footprint.u;
    block.v[i] = footprint.v;
    block.du[i] = footprint.du;
    block.dv[i] = footprint.dv;
    block.longer_squared[i] = footprint.longer_squared;
    block.red[i] = block.green[i] = block.blue[i] = 0.0f;
  }
}

/// Where the samples of a block are, at (u, v) + offset * (du, dv).
RGBD_SFM_FUSION_MULTIVERSION
void findSquares(const MipTexture::Level& level, float scale_x, float scale_y, float offset, Block& block) {
  const int width = level.width;
  const float most_x = static_cast<float>(level.width) - 1.001f;
  const float most_y = static_cast<float>(level.height) - 1.001f;
  for (int i = 0; i < kBlock; ++i) {
    const TexelSquare s = texelSquare(block.u[i] + offset * block.du[i], block.v[i] + offset * block.dv[i],
                                      scale_x, scale_y, width, most_x, most_y);
    block.index[i] = s.index;
    block.right[i] = s.right;
    block.down[i] = s.down;
  }
}

/// Fetches the texels: the only part that can't be vector code, so it is two loads of two texels each.
void fetchTexels(const std::uint32_t* texels, int width, Block& block) {
  for (int i = 0; i < kBlock; ++i) {
    const std::uint32_t* texel = texels + block.index[i];
    std::memcpy(block.upper[i], texel, sizeof block.upper[i]);
    std::memcpy(block.lower[i], texel + width, sizeof block.lower[i]);
  }
}

/// Adds weight * colour.
RGBD_SFM_FUSION_MULTIVERSION
void addSamples(Block& block) {
  for (int i = 0; i < kBlock; ++i) {
    const std::uint32_t a = block.upper[i][0], b = block.upper[i][1], c = block.lower[i][0],
                        d = block.lower[i][1];
    const float right = block.right[i], down = block.down[i];
    block.red[i] += block.weight[i] * blended(a, b, c, d, 0, right, down);
    block.green[i] += block.weight[i] * blended(a, b, c, d, 8, right, down);
    block.blue[i] += block.weight[i] * blended(a, b, c, d, 16, right, down);
  }
}

RGBD_SFM_FUSION_MULTIVERSION
void store(const Block& block, std::uint32_t* __restrict rgbx) {
  for (int i = 0; i < kBlock; ++i) {
    const auto red = static_cast<std::int32_t>(block.red[i] + 0.5f);
    const auto green = static_cast<std::int32_t>(block.green[i] + 0.5f);
    const auto blue = static_cast<std::int32_t>(block.blue[i] + 0.5f);
    rgbx[i] = static_cast<std::uint32_t>(red | (green << 8) | (blue << 16));
  }
}

/// Texture levels are blended over this part of the way from one to the next only: a blend is two look-ups.
constexpr float kBlendFrom = 0.25f, kBlendTo = 0.75f;

/// Weights of the finer of two levels: falls from 1 / taps to 0 on the way from level `fine` to the next.
RGBD_SFM_FUSION_MULTIVERSION
void findFineWeights(float fine, float taps, Block& block) {
  constexpr int kOne = 1 << 16;
  const float scale = 1.0f / (static_cast<float>(kOne) * taps);
  for (int i = 0; i < kBlock; ++i) {
    const float way = (levelFor(block.longer_squared[i], taps) - fine - kBlendFrom) / (kBlendTo - kBlendFrom);
    block.weight[i] = scale * static_cast<float>(kOne - std::clamp(static_cast<int>(way * kOne), 0, kOne));
  }
}

void addLevel(const MipTexture& texture, int index, int taps, Block& block) {
  const MipTexture::Level &level = texture.levels()[static_cast<std::size_t>(index)],
                          &largest = texture.levels()[0];
  const float scale_x = static_cast<float>(level.width) / static_cast<float>(largest.width);
  const float scale_y = static_cast<float>(level.height) / static_cast<float>(largest.height);
  for (int tap = 0; tap < taps; ++tap) {
    const float offset = (static_cast<float>(tap) + 0.5f) / static_cast<float>(taps) - 0.5f;
    findSquares(level, scale_x, scale_y, offset, block);
    fetchTexels(texture.texels() + level.offset, level.width, block);
    addSamples(block);
  }
}

/// Colours up to kBlock pixels.
/// @param rgbx room for kBlock pixels
void shadeBlock(const RowForms& forms, const MipTexture& texture, int first_step, int count, Block& block,
                std::uint32_t* rgbx) {
  findFootprints(forms, static_cast<float>(first_step), block);
  const int taps = tapsFor(footprintAt(forms, static_cast<float>(first_step + count / 2)));
  // Footprints grow or shrink along a row: its ends have the extremes.
  const auto level_at = [&](int i) { return levelFor(block.longer_squared[i], static_cast<float>(taps)); };
  const float finest = std::min(level_at(0), level_at(count - 1));
  const float coarsest = std::max(level_at(0), level_at(count - 1));
  const int last = static_cast<int>(texture.levels().size()) - 1;
  const int fine = static_cast<int>(limited(finest, static_cast<float>(last)));
  const float whole = 1.0f / static_cast<float>(taps);
  if (coarsest <= static_cast<float>(fine) + kBlendFrom || fine == last) {
    std::fill(block.weight, block.weight + kBlock, whole);
    addLevel(texture, fine, taps, block);
  } else if (finest >= static_cast<float>(fine) + kBlendTo) {
    std::fill(block.weight, block.weight + kBlock, whole);
    addLevel(texture, fine + 1, taps, block);
  } else {
    findFineWeights(static_cast<float>(fine), static_cast<float>(taps), block);
    addLevel(texture, fine, taps, block);
    for (float& weight : block.weight) weight = whole - weight;
    addLevel(texture, fine + 1, taps, block);
  }
  store(block, rgbx);
}

/// Marks pixels that differ from one of their four neighbours.
RGBD_SFM_FUSION_MULTIVERSION
void findOutline(const std::int32_t* above, const std::int32_t* here, const std::int32_t* below, int width,
                 std::uint8_t* __restrict outline) {
  for (int x = 1; x < width - 1; ++x) {
    const std::int32_t differs =
        (here[x] ^ above[x]) | (here[x] ^ below[x]) | (here[x] ^ here[x - 1]) | (here[x] ^ here[x + 1]);
    outline[x] = differs != 0;
  }
  outline[0] = here[0] != above[0] || here[0] != below[0] || here[0] != here[1];
  const int last = width - 1;
  outline[last] = here[last] != above[last] || here[last] != below[last] || here[last] != here[last - 1];
}

}  // namespace

void Shader::shadeRow(const Scene& scene, const GeometryBuffer& geometry, int row,
                      std::uint32_t* rgbx) const {
  const std::int32_t* surface = geometry.surface[row];
  const int width = geometry.surface.cols;
  Block block;
  std::array<std::uint32_t, kBlock> last;
  for (int x0 = 0, x1 = 0; x0 < width; x0 = x1) {
    for (x1 = x0 + 1; x1 < width && surface[x1] == surface[x0];) ++x1;
    if (surface[x0] == GeometryBuffer::kNothing) {
      std::fill(rgbx + x0, rgbx + x1, 0U);
      continue;
    }
    const MipTexture& texture = geometry.textureOf(scene, surface[x0]);
    const RowForms forms(geometry.surfaces[static_cast<std::size_t>(surface[x0])], texture, x0, row);
    for (int x = x0; x < x1; x += kBlock) {
      const int count = std::min(kBlock, x1 - x);
      // Colours beyond the run are wrong, and replaced by the runs to the right.
      const bool room = x + kBlock <= width;
      shadeBlock(forms, texture, x - x0, count, block, room ? rgbx + x : last.data());
      if (!room) std::copy_n(last.begin(), count, rgbx + x);
    }
  }
}

void Shader::shade(const Scene& scene, const GeometryBuffer& geometry, cv::Mat& rgbx) {
  rgbx.create(geometry.surface.size(), CV_8UC4);
  for (int row = 0; row < rgbx.rows; ++row) shadeRow(scene, geometry, row, rgbx.ptr<std::uint32_t>(row));
  outline_.resize(static_cast<std::size_t>(rgbx.cols));
  for (int row = 0; row < rgbx.rows; ++row) {
    findOutline(geometry.surface[std::max(row - 1, 0)], geometry.surface[row],
                geometry.surface[std::min(row + 1, rgbx.rows - 1)], rgbx.cols, outline_.data());
    auto* out = rgbx.ptr<cv::Vec4b>(row);
    for (int x = 0; x < rgbx.cols; ++x) {
      if (outline_[static_cast<std::size_t>(x)] != 0) smoothOutline(scene, geometry, x, row, out[x]);
    }
  }
}

}  // namespace rgbd_sfm_fusion
