// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/scene/rasteriser.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kNearPlane = 0.02;  // [m] nothing is seen that is closer

// Neighbouring patches share their edges; a pixel exactly on one must belong to at least one of them.
constexpr double kOverlap = 1e-9;

/// The pixels x0 to x1 of a row.
struct Span {
  double x0;
  double x1;

  /// Keeps those where form >= 0.
  void clip(const AffineForm& form, int row) {
    const double at_zero = form.at(0.0, row);
    if (form.dx > 0.0) {
      x0 = std::max(x0, -at_zero / form.dx);
    } else if (form.dx < 0.0) {
      x1 = std::min(x1, -at_zero / form.dx);
    } else if (at_zero < 0.0) {
      x1 = x0 - 1.0;
    }
  }
};

AffineForm difference(const AffineForm& a, const AffineForm& b) {
  return {a.constant - b.constant, a.dx - b.dx, a.dy - b.dy};
}

AffineForm raised(AffineForm form, double by) {
  form.constant += by;
  return form;
}

/// Not negative inside the patch: u >= 0, u <= 1, v >= 0, v <= 1, Z > 0.
std::array<AffineForm, 5> inside(const ProjectedPatch& p) {
  return {raised(p.u, kOverlap), raised(difference(p.inverse_depth, p.u), kOverlap), raised(p.v, kOverlap),
          raised(difference(p.inverse_depth, p.v), kOverlap), raised(p.inverse_depth, -1e-6)};
}

/// A row's product with the ray of a pixel, ((x - cx) / fx, (y - cy) / fy, 1).
/// @param row of the inverse of [edge_u edge_v origin] in camera axes
AffineForm overPixels(const Eigen::RowVector3d& row, const PinholeCamera& camera) {
  const double dx = row.x() / camera.fx, dy = row.y() / camera.fy;
  return {row.z() - dx * camera.cx - dy * camera.cy, dx, dy};
}

/// Rows that a patch may touch: all of them when part of it lies behind the camera.
void findRows(const std::array<Eigen::Vector3d, 4>& corners, const PinholeCamera& camera, ProjectedPatch& p) {
  double top = camera.height, bottom = -1.0, left = camera.width, right = -1.0;
  int behind = 0;
  for (const Eigen::Vector3d& corner : corners) {
    if (corner.z() < kNearPlane) {
      ++behind;
      continue;
    }
    const Eigen::Vector2d pixel = camera.project(corner);
    top = std::min(top, pixel.y());
    bottom = std::max(bottom, pixel.y());
    left = std::min(left, pixel.x());
    right = std::max(right, pixel.x());
  }
  p.first_row = 0;
  p.last_row = camera.height - 1;
  if (behind == 4 || (behind == 0 && (right < 0.0 || left > camera.width - 1))) p.visible = false;
  if (behind > 0) return;
  p.first_row = static_cast<int>(std::ceil(std::clamp(top, 0.0, 1.0 * camera.height)));
  p.last_row = static_cast<int>(std::floor(std::clamp(bottom, -1.0, camera.height - 1.0)));
}

/// @param handedness 1; -1 for mirrored patches, whose front and back are exchanged
ProjectedPatch projected(const Patch& patch, const PinholeCamera& camera, const SE3& T_camera_world,
                         double handedness) {
  const Eigen::Vector3d origin = T_camera_world * patch.origin;
  const Eigen::Vector3d edge_u = T_camera_world.rotation() * patch.edge_u;
  const Eigen::Vector3d edge_v = T_camera_world.rotation() * patch.edge_v;
  ProjectedPatch p;
  const double determinant = origin.dot(edge_u.cross(edge_v));
  p.visible = handedness * determinant > 1e-9;
  if (!p.visible) return p;
  p.u = overPixels(edge_v.cross(origin).transpose() / determinant, camera);
  p.v = overPixels(origin.cross(edge_u).transpose() / determinant, camera);
  p.inverse_depth = overPixels(edge_u.cross(edge_v).transpose() / determinant, camera);
  findRows({origin, origin + edge_u, origin + edge_v, origin + edge_u + edge_v}, camera, p);
  return p;
}

Patch reflected(const Patch& patch, const Patch& mirror) {
  const Eigen::Vector3d n = mirror.normal();
  const auto flip = [&n](const Eigen::Vector3d& v) -> Eigen::Vector3d { return v - 2.0 * n.dot(v) * n; };
  return {mirror.origin + flip(patch.origin - mirror.origin), flip(patch.edge_u), flip(patch.edge_v),
          patch.material};
}

/// Keeps the nearer surface, pixel by pixel.
RGBD_SFM_FUSION_MULTIVERSION
void drawSpan(const AffineForm& inverse_depth, std::int32_t index, int row, int x0, int x1,
              float* __restrict nearest, std::int32_t* __restrict surface) {
  const float start = static_cast<float>(inverse_depth.at(x0, row)),
              slope = static_cast<float>(inverse_depth.dx);
  for (int x = x0; x <= x1; ++x) {
    const float here = start + slope * static_cast<float>(x - x0);
    const bool nearer = here > nearest[x];
    nearest[x] = nearer ? here : nearest[x];
    surface[x] = nearer ? index : surface[x];
  }
}

/// Puts what the mirror shows in the place of the glass.
RGBD_SFM_FUSION_MULTIVERSION
void mirrorRow(std::int32_t glass, const std::int32_t* image, int width, std::int32_t* __restrict surface) {
  for (int x = 0; x < width; ++x) {
    const bool shown = (surface[x] == glass) & (image[x] != GeometryBuffer::kNothing);
    surface[x] = shown ? image[x] : surface[x];
  }
}

template <class Clips>
void drawPatch(const ProjectedPatch& p, std::int32_t index, const Clips& clips, cv::Mat_<float>& nearest,
               cv::Mat_<std::int32_t>& surface) {
  if (!p.visible) return;
  const auto own_clips = inside(p);
  for (int row = p.first_row; row <= p.last_row; ++row) {
    Span span{0.0, nearest.cols - 1.0};
    for (const AffineForm& form : own_clips) span.clip(form, row);
    for (const AffineForm& form : clips) span.clip(form, row);
    if (!(span.x0 <= span.x1)) continue;
    drawSpan(p.inverse_depth, index, row, static_cast<int>(std::ceil(span.x0)),
             static_cast<int>(std::floor(span.x1)), nearest[row], surface[row]);
  }
}

}  // namespace

void Rasteriser::draw(const Scene& scene, const PinholeCamera& camera, const SE3& T_world_camera,
                      GeometryBuffer& buffer) {
  const SE3 T_camera_world = T_world_camera.inverse();
  buffer.inverse_depth.create(camera.height, camera.width);
  buffer.surface.create(camera.height, camera.width);
  buffer.inverse_depth.setTo(0.0);
  buffer.surface.setTo(GeometryBuffer::kNothing);
  buffer.patch_count = scene.patches.size();
  buffer.surfaces.resize(2 * scene.patches.size());
  for (std::size_t i = 0; i < scene.patches.size(); ++i) {
    buffer.surfaces[i] = projected(scene.patches[i], camera, T_camera_world, 1.0);
    buffer.surfaces[scene.patches.size() + i].visible = false;
    drawPatch(buffer.surfaces[i], static_cast<std::int32_t>(i), std::array<AffineForm, 0>{},
              buffer.inverse_depth, buffer.surface);
  }
  if (scene.mirror && buffer.surfaces[*scene.mirror].visible) {
    const Patch& mirror = scene.patches[*scene.mirror];
    for (std::size_t i = 0; i < scene.patches.size(); ++i) {
      if (i == *scene.mirror) continue;
      buffer.surfaces[scene.patches.size() + i] =
          projected(reflected(scene.patches[i], mirror), camera, T_camera_world, -1.0);
    }
    drawMirror(scene, camera, buffer);
  }
}

void Rasteriser::drawMirror(const Scene& scene, const PinholeCamera& camera, GeometryBuffer& buffer) {
  const ProjectedPatch& glass = buffer.surfaces[*scene.mirror];
  if (glass.first_row > glass.last_row) return;
  const cv::Range rows(glass.first_row, glass.last_row + 1);
  mirror_inverse_depth_.create(camera.height, camera.width);
  mirror_surface_.create(camera.height, camera.width);
  mirror_inverse_depth_.rowRange(rows).setTo(0.0);
  mirror_surface_.rowRange(rows).setTo(GeometryBuffer::kNothing);
  const auto frame = inside(glass);
  for (std::size_t i = buffer.patch_count; i < buffer.surfaces.size(); ++i) {
    ProjectedPatch p = buffer.surfaces[i];
    p.first_row = std::max(p.first_row, glass.first_row);
    p.last_row = std::min(p.last_row, glass.last_row);
    // Only what appears inside the frame and behind the glass.
    const std::array<AffineForm, 5> clips = {frame[0], frame[1], frame[2], frame[3],
                                             difference(glass.inverse_depth, p.inverse_depth)};
    drawPatch(p, static_cast<std::int32_t>(i), clips, mirror_inverse_depth_, mirror_surface_);
  }
  for (int row = rows.start; row < rows.end; ++row) {
    mirrorRow(static_cast<std::int32_t>(*scene.mirror), mirror_surface_[row], camera.width,
              buffer.surface[row]);
  }
}

}  // namespace rgbd_sfm_fusion
