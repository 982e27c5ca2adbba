// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/scene/shader.h"

#include <array>

#include "rgbd_sfm_fusion/scene/texture_sampling.h"

namespace rgbd_sfm_fusion {
namespace {

/// What may be seen within a pixel: what its neighbours show.
struct Candidates {
  std::array<std::int32_t, 9> surfaces;
  int count = 0;
  bool mirror = false;

  void add(std::int32_t surface) {
    for (int i = 0; i < count; ++i) {
      if (surfaces[static_cast<std::size_t>(i)] == surface) return;
    }
    surfaces[static_cast<std::size_t>(count++)] = surface;
  }
};

Candidates candidatesAround(const GeometryBuffer& geometry, int x, int y) {
  Candidates candidates;
  for (int row = std::max(y - 1, 0); row <= std::min(y + 1, geometry.surface.rows - 1); ++row) {
    for (int column = std::max(x - 1, 0); column <= std::min(x + 1, geometry.surface.cols - 1); ++column) {
      const std::int32_t surface = geometry.surface(row, column);
      if (surface == GeometryBuffer::kNothing) continue;
      candidates.add(surface);
      candidates.mirror |= geometry.mirrored(surface);
    }
  }
  return candidates;
}

/// The nearest candidate of one side of the mirror; kNothing if none of them is there.
std::int32_t nearest(const GeometryBuffer& geometry, const Candidates& candidates, bool mirrored, double x,
                     double y, double& inverse_depth) {
  std::int32_t found = GeometryBuffer::kNothing;
  for (int i = 0; i < candidates.count; ++i) {
    const std::int32_t surface = candidates.surfaces[static_cast<std::size_t>(i)];
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

std::int32_t surfaceAt(const GeometryBuffer& geometry, const Candidates& candidates,
                       std::optional<std::size_t> mirror, double x, double y) {
  double inverse_depth = 0.0;
  const std::int32_t direct = nearest(geometry, candidates, false, x, y, inverse_depth);
  if (!candidates.mirror) return direct;
  const ProjectedPatch& glass = geometry.surfaces[*mirror];
  if (glass.inverse_depth.at(x, y) < inverse_depth || !glass.contains(x, y)) return direct;
  double behind_glass = 0.0;
  return nearest(geometry, candidates, true, x, y, behind_glass);
}

const MipTexture& textureOf(const Scene& scene, const GeometryBuffer& geometry, std::int32_t surface) {
  return scene.textures[static_cast<std::size_t>(surface) % geometry.patch_count];
}

/// Replaces a pixel on an outline by the mean of four samples, on a turned grid.
void smoothPixel(const Scene& scene, const GeometryBuffer& geometry, int x, int y, std::uint8_t* rgbx) {
  constexpr std::array<std::array<double, 2>, 4> kOffsets = {
      {{-0.125, -0.375}, {0.375, -0.125}, {0.125, 0.375}, {-0.375, 0.125}}};
  const std::int32_t centre = geometry.surface(y, x);
  const Candidates candidates = candidatesAround(geometry, x, y);
  std::array<std::int32_t, 4> surfaces{};
  bool uniform = true;
  for (std::size_t i = 0; i < 4; ++i) {
    surfaces[i] = surfaceAt(geometry, candidates, scene.mirror, x + kOffsets[i][0], y + kOffsets[i][1]);
    if (surfaces[i] == GeometryBuffer::kNothing) surfaces[i] = centre;
    uniform &= surfaces[i] == centre;
  }
  if (uniform) return;
  cv::v_float32x4 sum = cv::v_setzero_f32();
  for (std::size_t i = 0; i < 4; ++i) {
    if (surfaces[i] == GeometryBuffer::kNothing) continue;
    const MipTexture& texture = textureOf(scene, geometry, surfaces[i]);
    const FootprintForms forms(geometry.surfaces[static_cast<std::size_t>(surfaces[i])], texture,
                               x + kOffsets[i][0], y + kOffsets[i][1]);
    sum += sampleTexture(texture, footprintAt(forms, 0.0f));
  }
  storeColour(sum * cv::v_setall_f32(0.25f), rgbx);
}

}  // namespace

void Shader::shadeRun(const ProjectedPatch& patch, const MipTexture& texture, int row, int x0, int x1,
                      std::uint8_t* rgbx) {
  const FootprintForms forms(patch, texture, x0, row);
  float *u = footprints_.u.data(), *v = footprints_.v.data(), *du = footprints_.du.data();
  float *dv = footprints_.dv.data(), *taps = footprints_.taps.data(), *level = footprints_.level.data();
  const int count = x1 - x0;
  for (int i = 0; i < count; ++i) {
    const Footprint f = footprintAt(forms, static_cast<float>(i));
    u[i] = f.u;
    v[i] = f.v;
    du[i] = f.du;
    dv[i] = f.dv;
    taps[i] = f.taps;
    level[i] = f.level;
  }
  for (int i = 0; i < count; ++i) {
    storeColour(sampleTexture(texture, {u[i], v[i], du[i], dv[i], taps[i], level[i]}), rgbx + 4 * (x0 + i));
  }
}

void Shader::shade(const Scene& scene, const GeometryBuffer& geometry, cv::Mat& rgbx) {
  rgbx.create(geometry.surface.size(), CV_8UC4);
  const int width = rgbx.cols;
  for (auto* column : {&footprints_.u, &footprints_.v, &footprints_.du, &footprints_.dv, &footprints_.taps,
                       &footprints_.level}) {
    column->resize(static_cast<std::size_t>(width));
  }
  for (int row = 0; row < rgbx.rows; ++row) {
    const std::int32_t* surface = geometry.surface[row];
    std::uint8_t* out = rgbx.ptr(row);
    for (int x0 = 0, x1 = 0; x0 < width; x0 = x1) {
      for (x1 = x0 + 1; x1 < width && surface[x1] == surface[x0];) ++x1;
      if (surface[x0] == GeometryBuffer::kNothing) {
        std::memset(out + 4 * x0, 0, static_cast<std::size_t>(4 * (x1 - x0)));
      } else {
        shadeRun(geometry.surfaces[static_cast<std::size_t>(surface[x0])],
                 textureOf(scene, geometry, surface[x0]), row, x0, x1, out);
      }
    }
  }
  for (int row = 0; row < rgbx.rows; ++row) {
    const std::int32_t* here = geometry.surface[row];
    const std::int32_t* above = geometry.surface[std::max(row - 1, 0)];
    const std::int32_t* below = geometry.surface[std::min(row + 1, rgbx.rows - 1)];
    for (int x = 0; x < width; ++x) {
      const bool outline = here[x] != above[x] || here[x] != below[x] ||
                           here[x] != here[std::max(x - 1, 0)] || here[x] != here[std::min(x + 1, width - 1)];
      if (outline) smoothPixel(scene, geometry, x, row, rgbx.ptr(row) + 4 * x);
    }
  }
}

}  // namespace rgbd_sfm_fusion
