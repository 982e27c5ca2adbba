// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/depth_residuals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "rgbd_sfm_fusion/image/image_squares.h"
#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

using Vector6f = Eigen::Matrix<float, 6, 1>;

constexpr int kCell = kSquare;             // [px]
constexpr float kMaxRelativeRange = 0.1F;  // of inverse depth in a square, over its mean
constexpr float kTukey = 0.02F;            // [1/m] larger differences are between different surfaces

/// Per column of a square: the sum of its inverse depths, and their range.
struct Columns {
  std::array<float, kCell> sum, least, largest;
};

RGBD_SFM_FUSION_MULTIVERSION
Columns collect(const float* corner, std::ptrdiff_t stride, float nearest, float farthest) {
  Columns columns;
  columns.sum.fill(0.0F);
  columns.least.fill(std::numeric_limits<float>::max());
  columns.largest.fill(0.0F);
  for (std::ptrdiff_t row = 0; row < kCell; ++row) {
    const float* depth = corner + row * stride;
    for (std::size_t x = 0; x < kCell; ++x) {
      const bool usable = (depth[x] >= nearest) & (depth[x] <= farthest);
      const float inverse = usable ? 1.0F / depth[x] : std::numeric_limits<float>::infinity();
      columns.sum[x] += inverse;
      columns.least[x] = std::min(columns.least[x], inverse);
      columns.largest[x] = std::max(columns.largest[x], inverse);
    }
  }
  return columns;
}

/// NaN where a pixel of the square has no depth, or where not all pixels are of one surface.
float meanInverseDepth(const DepthImage& depth, const cv::Point& corner, float nearest, float farthest) {
  const Columns columns = collect(depth[corner.y] + corner.x, depth.cols, nearest, farthest);
  const float range = *std::max_element(columns.largest.begin(), columns.largest.end()) -
                      *std::min_element(columns.least.begin(), columns.least.end());
  const float mean =
      std::accumulate(columns.sum.begin(), columns.sum.end(), 0.0F) / static_cast<float>(kCell * kCell);
  const bool one_surface = std::isfinite(mean) && range <= kMaxRelativeRange * mean;
  return one_surface ? mean : kNoDepth;
}

struct Sample {
  float value, slope_u, slope_v;
};

/// Bilinear value and slopes at (u, v), which has four neighbours; none if the neighbours are not of one
/// surface.
std::optional<Sample> sample(const cv::Mat_<float>& cells, float u, float v) {
  const int column = static_cast<int>(u), row = static_cast<int>(v);
  const float a = u - static_cast<float>(column), b = v - static_cast<float>(row);
  const float *upper = cells[row] + column, *lower = cells[row + 1] + column;
  const float du = (1.0F - b) * (upper[1] - upper[0]) + b * (lower[1] - lower[0]);
  const float dv = (1.0F - a) * (lower[0] - upper[0]) + a * (lower[1] - upper[1]);
  const float value =
      (1.0F - b) * ((1.0F - a) * upper[0] + a * upper[1]) + b * ((1.0F - a) * lower[0] + a * lower[1]);
  const float steepest = std::max(std::abs(du), std::abs(dv));
  const float twist = std::abs(upper[1] + lower[0] - upper[0] - lower[1]);
  const bool one_surface = steepest <= kMaxRelativeRange * value && twist <= kTukey;  // false for NaN
  return one_surface ? std::optional<Sample>({value, du, dv}) : std::nullopt;
}

}  // namespace

void DepthCells::compute(const DepthImage& depth, const PinholeCamera& camera, const DepthNoiseModel& noise) {
  camera_ = {camera.width / kCell, camera.height / kCell,           camera.fx / kCell,
             camera.fy / kCell,    (camera.cx + 0.5) / kCell - 0.5, (camera.cy + 0.5) / kCell - 0.5};
  inverse_depth_.create(camera_.height, camera_.width);
  for (int row = 0; row < camera_.height; ++row) {
    for (int column = 0; column < camera_.width; ++column) {
      inverse_depth_(row, column) =
          meanInverseDepth(depth, {column * kCell, row * kCell}, noise.min_range, noise.max_range);
    }
  }
}

void DepthCells::leaveOut(const cv::Mat_<std::uint8_t>& squares) {
  if (squares.empty() || empty()) return;
  for (int row = 0; row < inverse_depth_.rows; ++row) {  // setTo() allocates
    for (int column = 0; column < inverse_depth_.cols; ++column) {
      if (squares(row, column) != 0) inverse_depth_(row, column) = kNoDepth;
    }
  }
}

PoseEquations depthEquations(const DepthPair& depth, const SE3& T_frame_keyframe, const SE3& T_frame_last) {
  const Vector6 step = T_frame_last.log();
  const SE3 T_depth_keyframe = SE3::exp(-depth.age * step) * T_frame_keyframe;
  const Eigen::Matrix3f R = T_depth_keyframe.rotationMatrix().cast<float>();
  const Eigen::Vector3f t = T_depth_keyframe.translation().cast<float>();
  // An error of the depth's time looks like this keyframe-side step.
  const Vector6f late = (depth.age_sigma * (T_frame_keyframe.inverse().adjoint() * step)).cast<float>();
  const PinholeCamera& camera = depth.keyframe->camera();
  const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
  const auto cx = static_cast<float>(camera.cx), cy = static_cast<float>(camera.cy);
  const auto max_u = static_cast<float>(camera.width - 1), max_v = static_cast<float>(camera.height - 1);
  const cv::Mat_<float>& keyframe = depth.keyframe->inverseDepth();

  PoseEquations equations;
  for (int row = 0; row < keyframe.rows; ++row) {
    Eigen::Matrix<float, 6, 6> H = Eigen::Matrix<float, 6, 6>::Zero();
    Vector6f g = Vector6f::Zero();
    for (int column = 0; column < keyframe.cols; ++column) {
      const float rho = keyframe(row, column);
      if (!(rho > 0.0F)) continue;
      const Eigen::Vector3f p =
          Eigen::Vector3f((static_cast<float>(column) - cx) / fx, (static_cast<float>(row) - cy) / fy, 1.0F) /
          rho;
      const Eigen::Vector3f q = R * p + t;
      if (!(q.z() > 0.0F)) continue;
      const float inverse_z = 1.0F / q.z();
      const float u = fx * q.x() * inverse_z + cx, v = fy * q.y() * inverse_z + cy;
      if (!(u >= 0.0F && v >= 0.0F && u < max_u && v < max_v)) continue;
      const std::optional<Sample> there = sample(depth.frame->inverseDepth(), u, v);
      if (!there) continue;

      // Jacobian of the residual by q, and by the keyframe-side step.
      const float along_x = there->slope_u * fx * inverse_z, along_y = there->slope_v * fy * inverse_z;
      const Eigen::Vector3f by_q(along_x, along_y,
                                 (inverse_z - along_x * q.x() - along_y * q.y()) * inverse_z);
      const Eigen::Vector3f by_p = R.transpose() * by_q;
      Vector6f J;
      J.head<3>() = by_p;
      J.tail<3>() = p.cross(by_p);

      const float shift = J.dot(late);
      const float information = 1.0F / (depth.sigma * depth.sigma + shift * shift);
      const float residual = there->value - inverse_z;
      const float inlier = std::max(0.0F, 1.0F - residual * residual / (kTukey * kTukey));
      const float weight = information * inlier * inlier;
      equations.compared += 1.0;
      equations.agreeing += inlier > 0.0F ? 1.0 : 0.0;
      H.noalias() += weight * J * J.transpose();
      g += weight * residual * J;
      equations.cost +=
          static_cast<double>(information * (kTukey * kTukey / 6.0F) * (1.0F - inlier * inlier * inlier));
    }
    const int strip = row * PoseEquations::kStrips / keyframe.rows;
    PoseEquations::Part& part = equations.strips[static_cast<std::size_t>(strip)];
    part.H += H.cast<double>();
    part.g += g.cast<double>();
  }
  for (const PoseEquations::Part& part : equations.strips) {
    equations.H += part.H;
    equations.g += part.g;
  }
  return equations;
}

}  // namespace rgbd_sfm_fusion
