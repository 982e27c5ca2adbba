// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/scene/shader.h"

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>

#include "outline.h"
#include "rgbd_sfm_fusion/multiversion.h"
#include "texture_sampling.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::int32_t kWhole = 1 << kTexelWeightBits;

/// Numbers of the pixels of a block.
struct Block {
  float u[kBlock], v[kBlock], du[kBlock], dv[kBlock], longer_squared[kBlock];
  std::int32_t weight[kBlock];  ///< of each of the next samples
  std::int32_t index[kBlock];
  std::uint32_t upper_left[kBlock], upper_right[kBlock], lower_left[kBlock], lower_right[kBlock];
  Texel sum[kBlock];
};

inline void findFootprints(const RowForms& forms, float first_step, Block& block) {
  const RowForms f = forms;
  for (int i = 0; i < kBlock; ++i) {
    const Footprint footprint = footprintAt(f, first_step + static_cast<float>(i));
    block.u[i] = footprint.u;
    block.v[i] = footprint.v;
    block.du[i] = footprint.du;
    block.dv[i] = footprint.dv;
    block.longer_squared[i] = footprint.longer_squared;
    block.sum[i] = 0;
  }
}

/// Two texture levels are blended only in this part of the way between them, since a blend takes two
/// look-ups.
constexpr float kBlendFrom = 0.4f, kBlendTo = 0.6f;

/// Weights of the coarser of two levels: grows from 0 to `whole` on the way from level `fine` to the next.
inline void findCoarseWeights(float fine, float last, float taps, std::int32_t whole, Block& block) {
  const float slope = static_cast<float>(whole) / (kBlendTo - kBlendFrom);
  for (int i = 0; i < kBlock; ++i) {
    const float way = limited(levelFor(block.longer_squared[i], taps), last) - fine - kBlendFrom;
    block.weight[i] = static_cast<std::int32_t>(limited(way * slope, static_cast<float>(whole)));
  }
}

/// Where the samples of a block are, at (u, v) + offset * (du, dv).
inline void findTexels(const MipTexture::Level& level, float scale_x, float scale_y, float offset,
                       Block& block) {
  const int width = level.width;
  const float most_x = static_cast<float>(level.width) - 1.01f;
  const float most_y = static_cast<float>(level.height) - 1.01f;
  for (int i = 0; i < kBlock; ++i) {
    const WeightedTexels t =
        weightedTexels(block.u[i] + offset * block.du[i], block.v[i] + offset * block.dv[i], scale_x, scale_y,
                       width, most_x, most_y, block.weight[i]);
    block.index[i] = t.index;
    block.upper_left[i] = t.upper_left;
    block.upper_right[i] = t.upper_right;
    block.lower_left[i] = t.lower_left;
    block.lower_right[i] = t.lower_right;
  }
}

/// The only part that can't be vector code.
inline void addTexels(const Texel* texels, int width, int count, Block& block) {
  for (int i = 0; i < count; ++i) {
    const Texel *upper = texels + block.index[i], *lower = upper + width;
    block.sum[i] += upper[0] * block.upper_left[i] + upper[1] * block.upper_right[i] +
                    lower[0] * block.lower_left[i] + lower[1] * block.lower_right[i];
  }
}

inline void addLevel(const MipTexture& texture, int index, int taps, int count, Block& block) {
  const MipTexture::Level &level = texture.levels()[static_cast<std::size_t>(index)],
                          &largest = texture.levels()[0];
  const float scale_x = static_cast<float>(level.width) / static_cast<float>(largest.width);
  const float scale_y = static_cast<float>(level.height) / static_cast<float>(largest.height);
  for (int tap = 0; tap < taps; ++tap) {
    const float offset = (static_cast<float>(tap) + 0.5f) / static_cast<float>(taps) - 0.5f;
    findTexels(level, scale_x, scale_y, offset, block);
    addTexels(texture.texels() + level.offset, level.width, count, block);
  }
}

inline void store(const Block& block, std::uint32_t* __restrict rgbx) {
  constexpr Texel kHalves = static_cast<Texel>(kWhole / 2) * texelOf(1, 1, 1);
  for (int i = 0; i < kBlock; ++i) {
    const Texel rounded = (block.sum[i] + kHalves) >> kTexelWeightBits;
    rgbx[i] = static_cast<std::uint32_t>((rounded & 0xffU) | ((rounded >> (kTexelFieldBits - 8)) & 0xff00U) |
                                         ((rounded >> (2 * kTexelFieldBits - 16)) & 0xff0000U));
  }
}

/// Colours up to kBlock pixels.
/// @param rgbx room for kBlock pixels
RGBD_SFM_FUSION_MULTIVERSION
void shadeBlock(const RowForms& forms, const MipTexture& texture, int first_step, int count, Block& block,
                std::uint32_t* rgbx) {
  findFootprints(forms, static_cast<float>(first_step), block);
  const int taps = tapsFor(footprintAt(forms, static_cast<float>(first_step + count / 2)));
  const auto last = static_cast<float>(texture.levels().size() - 1);
  const auto level_at = [&](int i) {
    return limited(levelFor(block.longer_squared[i], static_cast<float>(taps)), last);
  };
  // Footprints grow or shrink steadily along a row, so the extremes are at its ends.
  const float finest = std::min(level_at(0), level_at(count - 1));
  const float coarsest = std::max(level_at(0), level_at(count - 1));
  const int fine = static_cast<int>(finest);
  const std::int32_t whole = kWhole / taps;
  findCoarseWeights(static_cast<float>(fine), last, static_cast<float>(taps), whole, block);
  if (coarsest > static_cast<float>(fine) + kBlendFrom) addLevel(texture, fine + 1, taps, count, block);
  if (finest < static_cast<float>(fine) + kBlendTo) {
    for (std::int32_t& weight : block.weight) weight = whole - weight;
    addLevel(texture, fine, taps, count, block);
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
      // Colours beyond the run are wrong; the runs to the right replace them.
      const bool room = x + kBlock <= width;
      shadeBlock(forms, texture, x - x0, count, block, room ? rgbx + x : last.data());
      if (!room) std::copy_n(last.begin(), count, rgbx + x);
    }
  }
}

void Shader::shade(const Scene& scene, const GeometryBuffer& geometry, cv::Mat& rgb) {
  rgbx_.create(geometry.surface.size());
  outline_.resize(static_cast<std::size_t>(rgbx_.cols));
  for (int row = 0; row < rgbx_.rows; ++row) shadeRow(scene, geometry, row, rgbx_.ptr<std::uint32_t>(row));
  cv::cvtColor(rgbx_, rgb, cv::COLOR_RGBA2RGB);
  for (int row = 0; row < rgb.rows; ++row) smoothRow(scene, geometry, row, rgb.ptr<cv::Vec3b>(row));
}

void Shader::smoothRow(const Scene& scene, const GeometryBuffer& geometry, int row, cv::Vec3b* rgb) {
  findOutline(geometry.surface[std::max(row - 1, 0)], geometry.surface[row],
              geometry.surface[std::min(row + 1, rgbx_.rows - 1)], rgbx_.cols, outline_.data());
  for (auto it = outline_.begin(); (it = std::find(it, outline_.end(), 1)) != outline_.end(); ++it) {
    const auto x = static_cast<int>(it - outline_.begin());
    rgb[x] = smoothedOutline(scene, geometry, rgbx_, x, row);
  }
}

}  // namespace rgbd_sfm_fusion
