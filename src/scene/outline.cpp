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
constexpr std::array<std::array<double, 2>, kSamples> kOffsets = {
    {{-0.125, -0.375}, {0.375, -0.125}, {0.125, 0.375}, {-0.375, 0.125}}};

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

/// The nearest candidate of one side of the mirror; kNothing if none of them is there.
std::int32_t nearest(const GeometryBuffer& geometry, const Candidates& candidates, bool mirrored, double x,
                     double y, double& inverse_depth) {
  std::int32_t found = GeometryBuffer::kNothing;
  for (const std::int32_t surface : candidates) {
    if (geometry.mirrored(surface) != mirrored) continue;
    const ProjectedPatch& patch = geometry.surfaces[static_cast<std::size_t>(surface)];
    const double here = patch.inverse_depth.at(x, y);
    if (here > inverse_depth && patch.contains(x, y)) {
      found = surface;
      inverse_depth = here;
    }
  }
  return found;
}

std::int32_t surfaceAt(const Scene& scene, const GeometryBuffer& geometry, const Candidates& candidates,
                       double x, double y) {
  double inverse_depth = 0.0;
  const std::int32_t direct = nearest(geometry, candidates, false, x, y, inverse_depth);
  if (!candidates.mirror()) return direct;
  const ProjectedPatch& glass = geometry.surfaces[*scene.mirror];
  if (glass.inverse_depth.at(x, y) < inverse_depth || !glass.contains(x, y)) return direct;
  double behind_glass = 0.0;
  return nearest(geometry, candidates, true, x, y, behind_glass);
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
  std::array<std::int32_t, kSamples> surfaces;
  float share_of_centre = 0.0f;
  for (std::size_t i = 0; i < kSamples; ++i) {
    surfaces[i] = surfaceAt(scene, geometry, candidates, x + kOffsets[i][0], y + kOffsets[i][1]);
    if (surfaces[i] == GeometryBuffer::kNothing) surfaces[i] = centre;
    if (surfaces[i] == centre) share_of_centre += 1.0f / kSamples;
  }
  if (share_of_centre > 0.99f) return;
  cv::Vec3f sum = share_of_centre * cv::Vec3f(rgbx[0], rgbx[1], rgbx[2]);
  for (const std::int32_t surface : surfaces) {
    if (surface == centre) continue;
    addColour(geometry.textureOf(scene, surface), geometry.surfaces[static_cast<std::size_t>(surface)], x, y,
              1.0f / kSamples, sum);
  }
  for (int channel = 0; channel < 3; ++channel) rgbx[channel] = cv::saturate_cast<std::uint8_t>(sum[channel]);
}

}  // namespace rgbd_sfm_fusion
