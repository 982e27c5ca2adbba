// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "outline.h"

#include <algorithm>
#include <array>

#include "texture_sampling.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::size_t kSamples = 4;

// In the pixel, on a turned grid: outlines near both axes get all four steps.
constexpr std::array<double, kSamples> kOffsetsX = {-0.125, 0.375, 0.125, -0.375};
constexpr std::array<double, kSamples> kOffsetsY = {-0.375, -0.125, 0.375, 0.125};

/// What may be seen within a pixel: what it and its neighbours show.
class Candidates {
 public:
  Candidates(const GeometryBuffer& geometry, int x, int y) {
    const std::int32_t* here = geometry.surface[y];
    add(here[x]);
    add(here[std::max(x - 1, 0)]);
    add(here[std::min(x + 1, geometry.surface.cols - 1)]);
    add(geometry.surface(std::max(y - 1, 0), x));
    add(geometry.surface(std::min(y + 1, geometry.surface.rows - 1), x));
    mirror_ = std::any_of(begin(), end(), [&](std::int32_t surface) { return geometry.mirrored(surface); });
  }

  const std::int32_t* begin() const { return surfaces_.data(); }
  const std::int32_t* end() const { return surfaces_.data() + count_; }
  bool mirror() const { return mirror_; }

 private:
  void add(std::int32_t surface) {
    if (surface != GeometryBuffer::kNothing && std::find(begin(), end(), surface) == end()) {
      surfaces_[count_++] = surface;
    }
  }

  std::array<std::int32_t, 5> surfaces_;
  std::size_t count_ = 0;
  bool mirror_ = false;
};

/// Inverse depth of a surface at the samples of a pixel; 0 where it is not.
using SampleDepths = std::array<float, kSamples>;

SampleDepths sampleDepths(const ProjectedPatch& patch, int x, int y) {
  const double depth = patch.inverse_depth.at(x, y), u = patch.u.at(x, y), v = patch.v.at(x, y);
  SampleDepths result;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const auto at_sample = [i](double centre, const AffineForm& form) {
      return static_cast<float>(centre + kOffsetsX[i] * form.dx + kOffsetsY[i] * form.dy);
    };
    const float d = at_sample(depth, patch.inverse_depth), su = at_sample(u, patch.u),
                sv = at_sample(v, patch.v);
    const bool inside = (d > 0.0f) & (su >= 0.0f) & (su <= d) & (sv >= 0.0f) & (sv <= d);
    result[i] = inside ? d : 0.0f;
  }
  return result;
}

/// Which surface is seen in each of the samples; kNothing where it is none of the candidates.
std::array<std::int32_t, kSamples> visibleSurfaces(const Scene& scene, const GeometryBuffer& geometry,
                                                   const Candidates& candidates, int x, int y) {
  std::array<std::int32_t, kSamples> direct, mirrored;
  direct.fill(GeometryBuffer::kNothing);
  mirrored.fill(GeometryBuffer::kNothing);
  SampleDepths direct_depth{}, mirrored_depth{};
  for (const std::int32_t surface : candidates) {
    const bool behind_glass = geometry.mirrored(surface);
    const SampleDepths here = sampleDepths(geometry.surfaces[static_cast<std::size_t>(surface)], x, y);
    auto& nearest = behind_glass ? mirrored : direct;
    SampleDepths& depth = behind_glass ? mirrored_depth : direct_depth;
    for (std::size_t i = 0; i < kSamples; ++i) {
      nearest[i] = here[i] > depth[i] ? surface : nearest[i];
      depth[i] = std::max(here[i], depth[i]);
    }
  }
  if (!candidates.mirror()) return direct;
  const SampleDepths glass = sampleDepths(geometry.surfaces[*scene.mirror], x, y);
  for (std::size_t i = 0; i < kSamples; ++i) direct[i] = glass[i] > direct_depth[i] ? mirrored[i] : direct[i];
  return direct;
}

/// Adds share * colour of a surface in a pixel's centre.
void addColour(const MipTexture& texture, const ProjectedPatch& patch, int x, int y, float share,
               cv::Vec3f& sum) {
  const Footprint footprint = footprintAt(RowForms(patch, texture, x, y), 0.0f);
  const float wanted = levelFor(footprint.longer_squared, static_cast<float>(tapsFor(footprint)));
  const float last = static_cast<float>(texture.levels().size() - 1);
  const MipTexture::Level& level = texture.levels()[static_cast<std::size_t>(limited(wanted + 0.5f, last))];
  const MipTexture::Level& largest = texture.levels().front();
  const TexelSquare s = texelSquare(
      footprint.u, footprint.v, static_cast<float>(level.width) / static_cast<float>(largest.width),
      static_cast<float>(level.height) / static_cast<float>(largest.height), level.width,
      static_cast<float>(level.width) - 1.001f, static_cast<float>(level.height) - 1.001f);
  const std::uint32_t* texel = texture.texels() + level.offset + s.index;
  for (int channel = 0; channel < 3; ++channel) {
    sum[channel] += share * blended(texel[0], texel[1], texel[level.width], texel[level.width + 1],
                                    8 * channel, s.right, s.down);
  }
}

}  // namespace

void smoothOutline(const Scene& scene, const GeometryBuffer& geometry, int x, int y, cv::Vec4b& rgbx) {
  const std::int32_t centre = geometry.surface(y, x);
  const Candidates candidates(geometry, x, y);
  std::array<std::int32_t, kSamples> seen = visibleSurfaces(scene, geometry, candidates, x, y);
  for (std::int32_t& surface : seen) surface = surface == GeometryBuffer::kNothing ? centre : surface;
  const auto share = [&seen](std::int32_t surface) {
    return static_cast<float>(std::count(seen.begin(), seen.end(), surface)) / kSamples;
  };
  const float share_of_centre = share(centre);
  if (share_of_centre > 0.99f) return;
  cv::Vec3f sum = share_of_centre * cv::Vec3f(rgbx[0], rgbx[1], rgbx[2]);
  for (const std::int32_t surface : candidates) {
    const float here = surface == centre ? 0.0f : share(surface);
    if (here == 0.0f) continue;
    addColour(geometry.textureOf(scene, surface), geometry.surfaces[static_cast<std::size_t>(surface)], x, y,
              here, sum);
  }
  for (int channel = 0; channel < 3; ++channel) rgbx[channel] = cv::saturate_cast<std::uint8_t>(sum[channel]);
}

}  // namespace rgbd_sfm_fusion
