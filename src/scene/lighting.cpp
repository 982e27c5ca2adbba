// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/scene/lighting.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rgbd_sfm_fusion {
namespace {

constexpr double kCell = 0.08;       // [m]
constexpr int kLightSamples = 3;     // each way: soft shadows without visible steps
constexpr float kClearance = 0.01f;  // [m] surfaces closer than this cast no shadow on each other

/// Whether anything is between two points, as vector code. Patches block light from both sides.
class Occluders {
 public:
  explicit Occluders(const std::vector<Patch>& patches) {
    for (const Patch& patch : patches) {
      const Eigen::Vector3d away = patch.edge_u.cross(patch.edge_v);
      const double area_squared = away.squaredNorm();
      addForm(kHeight, away / std::sqrt(area_squared), patch.origin);
      addForm(kU, patch.edge_v.cross(away) / area_squared, patch.origin);
      addForm(kV, away.cross(patch.edge_u) / area_squared, patch.origin);
    }
  }

  bool between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const {
    const Eigen::Vector3f a = from.cast<float>(), b = to.cast<float>();
    const auto count = static_cast<int>(forms_[0].size());
    int hits = 0;
    for (int i = 0; i < count; ++i) {
      const float height_a = at(kHeight, i, a), height_b = at(kHeight, i, b);
      const float way = height_a / (height_a - height_b);
      const float u_a = at(kU, i, a), v_a = at(kV, i, a);
      const float u = u_a + way * (at(kU, i, b) - u_a), v = v_a + way * (at(kV, i, b) - v_a);
      const float closer = std::min(std::abs(height_a), std::abs(height_b));
      const bool crosses = (height_a * height_b < 0.0f) & (closer > kClearance);
      hits += crosses & (u >= 0.0f) & (u <= 1.0f) & (v >= 0.0f) & (v <= 1.0f);
    }
    return hits > 0;
  }

 private:
  enum Form : std::size_t { kHeight, kU, kV };  // over the patch's plane [m], and its coordinates

  void addForm(Form form, const Eigen::Vector3d& gradient, const Eigen::Vector3d& origin) {
    for (int axis = 0; axis < 3; ++axis)
      forms_[4 * form + static_cast<std::size_t>(axis)].push_back(static_cast<float>(gradient[axis]));
    forms_[4 * form + 3].push_back(static_cast<float>(-gradient.dot(origin)));
  }

  float at(Form form, int patch, const Eigen::Vector3f& p) const {
    const auto i = static_cast<std::size_t>(patch);
    return forms_[4 * form][i] * p[0] + forms_[4 * form + 1][i] * p[1] + forms_[4 * form + 2][i] * p[2] +
           forms_[4 * form + 3][i];
  }

  std::array<std::vector<float>, 12> forms_;  ///< gradient and constant of three affine forms, by patch
};

double received(const Occluders& occluders, const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                const AreaLight& light) {
  const Eigen::Vector3d forward = light.edge_v.cross(light.edge_u).normalized();
  double sum = 0.0;
  for (int i = 0; i < kLightSamples * kLightSamples; ++i) {
    const double u = (i % kLightSamples + 0.5) / kLightSamples, v = (i / kLightSamples + 0.5) / kLightSamples;
    const Eigen::Vector3d source = light.origin + u * light.edge_u + v * light.edge_v;
    const Eigen::Vector3d way = source - point;
    const double distance_squared = way.squaredNorm();
    const double incidence = normal.dot(way), emission = -forward.dot(way);
    if (incidence <= 0.0 || emission <= 0.0 || occluders.between(point, source)) continue;
    // Within some 30 cm, one would see that the light is nine points.
    sum += incidence * emission / (distance_squared * std::max(distance_squared, 0.1));
  }
  return light.power * sum / (kLightSamples * kLightSamples);
}

}  // namespace

cv::Mat lightMap(const std::vector<Patch>& patches, std::size_t index, const Lighting& lighting) {
  const Patch& patch = patches[index];
  const Eigen::Vector3d normal = patch.normal();
  const Occluders occluders(patches);
  const auto cells = [](double length) { return std::max(2, static_cast<int>(std::ceil(length / kCell))); };
  cv::Mat_<float> map(cells(patch.edge_v.norm()), cells(patch.edge_u.norm()));
  const double direct = lighting.ambient + (patch.material == Material::kSunlit ? lighting.sun : 0.0);
  for (int y = 0; y < map.rows; ++y) {
    for (int x = 0; x < map.cols; ++x) {
      const Eigen::Vector3d point = patch.origin + (x + 0.5) / map.cols * patch.edge_u +
                                    (y + 0.5) / map.rows * patch.edge_v + 1e-3 * normal;
      double light = direct;
      for (const AreaLight& source : lighting.lights) light += received(occluders, point, normal, source);
      map(y, x) = static_cast<float>(std::pow(light, 1.0 / 2.2));  // as a display shows it
    }
  }
  return map;
}

}  // namespace rgbd_sfm_fusion
