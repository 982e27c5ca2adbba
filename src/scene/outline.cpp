// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "outline.h"

#include <algorithm>
#include <array>

namespace rgbd_sfm_fusion {
namespace {

constexpr std::size_t kSamples = 4;

// In the pixel, on a turned grid: outlines near both axes get all four steps.
constexpr std::array<float, kSamples> kOffsetsX = {-0.125f, 0.375f, 0.125f, -0.375f};
constexpr std::array<float, kSamples> kOffsetsY = {-0.375f, -0.125f, 0.375f, 0.125f};

/// The surfaces that may be seen within a pixel: its own and its neighbours', with their colours there. The
/// surface at the pixel's centre comes first.
class Candidates {
 public:
  Candidates(const GeometryBuffer& geometry, const cv::Mat_<cv::Vec4b>& rgbx, int x, int y) {
    const auto add = [&](int at_x, int at_y) {
      const std::int32_t surface = geometry.surface(at_y, at_x);
      for (std::size_t i = 0; i < count_; ++i) {
        if (surfaces_[i] == surface) return;
      }
      surfaces_[count_] = surface;
      colours_[count_++] = &rgbx(at_y, at_x);
      mirror_ |= geometry.mirrored(surface);
    };
    add(x, y);
    add(std::max(x - 1, 0), y);
    add(std::min(x + 1, rgbx.cols - 1), y);
    add(x, std::max(y - 1, 0));
    add(x, std::min(y + 1, rgbx.rows - 1));
  }

  std::int32_t count() const { return static_cast<std::int32_t>(count_); }
  std::int32_t surface(std::int32_t i) const { return surfaces_[static_cast<std::size_t>(i)]; }
  const cv::Vec4b& colour(std::int32_t i) const { return *colours_[static_cast<std::size_t>(i)]; }
  bool mirror() const { return mirror_; }

 private:
  std::array<std::int32_t, 5> surfaces_;
  std::array<const cv::Vec4b*, 5> colours_;
  std::size_t count_ = 0;
  bool mirror_ = false;
};

/// Inverse depth of a surface at the samples of a pixel; 0 where the surface is not seen.
using SampleDepths = std::array<float, kSamples>;

std::array<float, kSamples> atSamples(const AffineForm& form, int x, int y) {
  const auto centre = static_cast<float>(form.at(x, y)), dx = static_cast<float>(form.dx),
             dy = static_cast<float>(form.dy);
  std::array<float, kSamples> result;
  for (std::size_t i = 0; i < kSamples; ++i) result[i] = centre + kOffsetsX[i] * dx + kOffsetsY[i] * dy;
  return result;
}

SampleDepths sampleDepths(const ProjectedPatch& patch, int x, int y) {
  const auto d = atSamples(patch.inverse_depth, x, y), u = atSamples(patch.u, x, y),
             v = atSamples(patch.v, x, y);
  SampleDepths result;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const bool inside = (d[i] > 0.0f) & (u[i] >= 0.0f) & (u[i] <= d[i]) & (v[i] >= 0.0f) & (v[i] <= d[i]);
    result[i] = inside ? d[i] : 0.0f;
  }
  return result;
}

/// Which candidate is seen in each sample; the first one where no candidate is.
std::array<std::int32_t, kSamples> visibleCandidates(const Scene& scene, const GeometryBuffer& geometry,
                                                     const Candidates& candidates, int x, int y) {
  std::array<std::int32_t, kSamples> direct{}, mirrored{};
  SampleDepths direct_depth{}, mirrored_depth{};
  for (std::int32_t candidate = 0; candidate < candidates.count(); ++candidate) {
    const std::int32_t surface = candidates.surface(candidate);
    if (surface == GeometryBuffer::kNothing) continue;
    const bool behind_glass = geometry.mirrored(surface);
    const SampleDepths here = sampleDepths(geometry.surfaces[static_cast<std::size_t>(surface)], x, y);
    auto& nearest = behind_glass ? mirrored : direct;
    SampleDepths& depth = behind_glass ? mirrored_depth : direct_depth;
    for (std::size_t i = 0; i < kSamples; ++i) {
      nearest[i] = here[i] > depth[i] ? candidate : nearest[i];
      depth[i] = std::max(here[i], depth[i]);
    }
  }
  if (!candidates.mirror()) return direct;
  const SampleDepths glass = sampleDepths(geometry.surfaces[*scene.mirror], x, y);
  for (std::size_t i = 0; i < kSamples; ++i) direct[i] = glass[i] > direct_depth[i] ? mirrored[i] : direct[i];
  return direct;
}

}  // namespace

cv::Vec3b smoothedOutline(const Scene& scene, const GeometryBuffer& geometry, const cv::Mat_<cv::Vec4b>& rgbx,
                          int x, int y) {
  const Candidates candidates(geometry, rgbx, x, y);
  std::array<unsigned, 3> sum{};
  for (const std::int32_t candidate : visibleCandidates(scene, geometry, candidates, x, y)) {
    const cv::Vec4b& colour = candidates.colour(candidate);
    for (std::size_t channel = 0; channel < 3; ++channel) sum[channel] += colour[static_cast<int>(channel)];
  }
  const auto mean = [](unsigned s) { return static_cast<std::uint8_t>((s + kSamples / 2) / kSamples); };
  return {mean(sum[0]), mean(sum[1]), mean(sum[2])};
}

}  // namespace rgbd_sfm_fusion
