// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/scene/lighting.h"

#include <algorithm>
#include <cmath>

namespace rgbd_sfm_fusion {
namespace {

constexpr double kCell = 0.06;       // [m]
constexpr int kLightSamples = 3;     // each way: soft shadows without visible steps
constexpr double kClearance = 0.01;  // [m] surfaces closer than this cast no shadow on each other

/// Patches block light from both sides.
bool blocked(const std::vector<Patch>& patches, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d way = to - from;
  const double margin = kClearance / way.norm();
  for (const Patch& patch : patches) {
    const Eigen::Vector3d away = patch.edge_u.cross(patch.edge_v);
    const double slope = away.dot(way);
    const Eigen::Vector3d offset = patch.origin - from;
    const double distance = away.dot(offset) / slope;
    if (!(distance > margin && distance < 1.0 - margin)) continue;
    const Eigen::Vector3d in_patch = distance * way - offset;
    const double area_squared = away.squaredNorm();
    const double u = in_patch.cross(patch.edge_v).dot(away);
    const double v = patch.edge_u.cross(in_patch).dot(away);
    if (u >= 0.0 && u <= area_squared && v >= 0.0 && v <= area_squared) return true;
  }
  return false;
}

double received(const std::vector<Patch>& patches, const Eigen::Vector3d& point,
                const Eigen::Vector3d& normal, const AreaLight& light) {
  const Eigen::Vector3d forward = light.edge_v.cross(light.edge_u).normalized();
  double sum = 0.0;
  for (int i = 0; i < kLightSamples * kLightSamples; ++i) {
    const double u = (i % kLightSamples + 0.5) / kLightSamples, v = (i / kLightSamples + 0.5) / kLightSamples;
    const Eigen::Vector3d source = light.origin + u * light.edge_u + v * light.edge_v;
    const Eigen::Vector3d way = source - point;
    const double distance_squared = way.squaredNorm();
    const double incidence = normal.dot(way), emission = -forward.dot(way);
    if (incidence <= 0.0 || emission <= 0.0 || blocked(patches, point, source)) continue;
    // Nearer than some 30 cm a light of nine points would show.
    sum += incidence * emission / (distance_squared * std::max(distance_squared, 0.1));
  }
  return light.power * sum / (kLightSamples * kLightSamples);
}

}  // namespace

cv::Mat lightMap(const std::vector<Patch>& patches, std::size_t index, const Lighting& lighting) {
  const Patch& patch = patches[index];
  const Eigen::Vector3d normal = patch.normal();
  const auto cells = [](double length) { return std::max(2, static_cast<int>(std::ceil(length / kCell))); };
  cv::Mat_<float> map(cells(patch.edge_v.norm()), cells(patch.edge_u.norm()));
  const double direct = lighting.ambient + (patch.material == Material::kSunlit ? lighting.sun : 0.0);
  for (int y = 0; y < map.rows; ++y) {
    for (int x = 0; x < map.cols; ++x) {
      const Eigen::Vector3d point = patch.origin + (x + 0.5) / map.cols * patch.edge_u +
                                    (y + 0.5) / map.rows * patch.edge_v + 1e-3 * normal;
      double light = direct;
      for (const AreaLight& source : lighting.lights) light += received(patches, point, normal, source);
      map(y, x) = static_cast<float>(std::pow(light, 1.0 / 2.2));  // as a display shows it
    }
  }
  return map;
}

}  // namespace rgbd_sfm_fusion
