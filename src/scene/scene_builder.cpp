// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/scene/scene_builder.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace rgbd_sfm_fusion {
namespace {

constexpr double kDecalGap = 1e-3;  // [m]
constexpr double kEyeLevel = 1.2;   // [m] nobody sees the underside of what is below

// Limits of the texture of a lit surface, so that no exposure saturates it.
constexpr double kBlack = 12.0;
constexpr double kWhite = 222.0;

cv::Mat lit(const cv::Mat& reflectance, const cv::Mat& light) {
  cv::Mat_<float> factor;
  cv::resize(light, factor, reflectance.size(), 0.0, 0.0, cv::INTER_LINEAR);
  cv::Mat image(reflectance.size(), CV_8UC3);
  for (int row = 0; row < image.rows; ++row) {
    const cv::Vec3b* in = reflectance.ptr<cv::Vec3b>(row);
    cv::Vec3b* out = image.ptr<cv::Vec3b>(row);
    for (int x = 0; x < image.cols; ++x) {
      for (int c = 0; c < 3; ++c) {
        const float exposed = factor(row, x) * static_cast<float>(in[x][c]) / 255.0f;
        // A camera's shoulder: highlights are compressed, not cut.
        const float shown = exposed < 0.6f ? exposed : 1.0f - 0.4f * std::exp((0.6f - exposed) / 0.4f);
        out[x][c] = cv::saturate_cast<std::uint8_t>(kBlack + (kWhite - kBlack) * static_cast<double>(shown));
      }
    }
  }
  return image;
}

}  // namespace

std::size_t SceneBuilder::add(const Patch& patch, const Paint& paint) {
  patches_.push_back(patch);
  reflectance_.push_back(paint(patch.edge_u.norm(), patch.edge_v.norm(), texel_));
  return patches_.size() - 1;
}

void SceneBuilder::addBox(const Eigen::Vector3d& base, const Eigen::Vector3d& size, double yaw,
                          const Paint& sides, const Paint& top, Material material) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Vector3d x = R.col(0) * size.x(), y = R.col(1) * size.y(), up(0, 0, size.z());
  const Eigen::Vector3d corner = base - 0.5 * x - 0.5 * y;
  add({corner + up, x, -up, material}, sides);
  add({corner + x + up, y, -up, material}, sides);
  add({corner + x + y + up, -x, -up, material}, sides);
  add({corner + y + up, -y, -up, material}, sides);
  add({corner + y + up, x, -y, material}, top);
  if (base.z() > kEyeLevel) add({corner, x, y, material}, sides);
}

void SceneBuilder::addSunlit(std::size_t index, const cv::Rect2d& uv) {
  const Patch& parent = patches_.at(index);
  const cv::Mat& paint = reflectance_.at(index);
  // Whole texels, so that the pattern goes on across the border.
  const int x0 = static_cast<int>(uv.x * paint.cols), x1 = static_cast<int>((uv.x + uv.width) * paint.cols);
  const int y0 = static_cast<int>(uv.y * paint.rows), y1 = static_cast<int>((uv.y + uv.height) * paint.rows);
  const double u0 = static_cast<double>(x0) / paint.cols, v0 = static_cast<double>(y0) / paint.rows;
  const Patch patch{parent.origin + u0 * parent.edge_u + v0 * parent.edge_v + kDecalGap * parent.normal(),
                    (static_cast<double>(x1) / paint.cols - u0) * parent.edge_u,
                    (static_cast<double>(y1) / paint.rows - v0) * parent.edge_v, Material::kSunlit};
  const cv::Mat part = paint(cv::Rect(x0, y0, x1 - x0, y1 - y0)).clone();
  patches_.push_back(patch);
  reflectance_.push_back(part);
}

void SceneBuilder::addMirror(const Patch& patch) {
  patches_.push_back(patch);
  patches_.back().material = Material::kMirror;
  reflectance_.emplace_back(2, 2, CV_8UC3, cv::Scalar::all(40));
}

Scene SceneBuilder::build(const Lighting& lighting) const {
  Scene scene;
  scene.patches = patches_;
  for (std::size_t i = 0; i < patches_.size(); ++i) {
    scene.textures.emplace_back(lit(reflectance_[i], lightMap(patches_, i, lighting)));
    if (patches_[i].material == Material::kMirror) scene.mirror = i;
  }
  return scene;
}

}  // namespace rgbd_sfm_fusion
