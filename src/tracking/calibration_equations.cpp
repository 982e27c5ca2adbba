// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/calibration_equations.h"

#include <algorithm>
#include <cmath>

#include "rgbd_sfm_fusion/sampling.h"
#include "rgbd_sfm_fusion/tracking/equation_tile.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kEvery = 2;  // of a level's points: neighbours say the same
constexpr int kParameters = CalibrationEquations::kParameters;

using Tile = EquationTile<kParameters>;
using LaneSums = EquationSums<kParameters>;

/// The last alignment, with what all points share.
struct Alignment {
  float R[9], t[3], t_in_keyframe[3];  // row-major T_frame_keyframe
  float velocity[3], rotation[3];      // motion of the frame during its readout
  float step_in_keyframe[6];           // motion since the last frame
  float keyframe_step[6];              // and of the keyframe in that time
  float fx, fy, cx, cy;                // of the level
  float inverse_height, middle;        // share of the readout at v: v * inverse_height - middle
  float gain, offset;
  float pixel;  // of the level, in a pixel of the full image
  float min_u, min_v, max_u, max_v;
  float noise_variance;  // of a residual [grey levels²]
  float huber;           // [σ]
  const float* image;
  int stride;
};

/// Every kEvery-th point from a point on.
struct Points {
  float x[kLanes], y[kLanes], rho[kLanes], rho_variance[kLanes], intensity[kLanes], gradient_x[kLanes],
      gradient_y[kLanes];
};

Points pointsFrom(const ReferencePoints& points, int first) {
  Points block;
  for (int l = 0; l < kLanes; ++l) {
    const auto i = static_cast<std::size_t>(std::min(first + kEvery * l, points.count - 1));
    block.x[l] = points.x[i], block.y[l] = points.y[i];
    block.rho[l] = points.inverse_depth[i], block.rho_variance[l] = points.inverse_depth_variance[i];
    block.intensity[l] = points.intensity[i];
    block.gradient_x[l] = points.gradient_x[i], block.gradient_y[l] = points.gradient_y[i];
  }
  return block;
}

/// Weighs a block of points as block `b` of the tile.
/// @param count  of its lanes that are to be counted
RGBD_SFM_FUSION_MULTIVERSION
void weigh(const Alignment& alignment, const Points& points, int count, int b, Tile& __restrict tile) {
  const Alignment a = alignment;
  float u[kLanes], v[kLanes], inside[kLanes], variance[kLanes];
  for (int l = 0; l < kLanes; ++l) {
    const float x = points.x[l], y = points.y[l], rho = points.rho[l];
    const float mx = a.R[0] * x + a.R[1] * y + a.R[2] + rho * a.t[0];
    const float my = a.R[3] * x + a.R[4] * y + a.R[5] + rho * a.t[1];
    const float mz = a.R[6] * x + a.R[7] * y + a.R[8] + rho * a.t[2];
    const float share = (a.fy * my / mz + a.cy) * a.inverse_height - a.middle;
    const float qx = mx + share * (a.rotation[1] * mz - a.rotation[2] * my + rho * a.velocity[0]);
    const float qy = my + share * (a.rotation[2] * mx - a.rotation[0] * mz + rho * a.velocity[1]);
    const float qz = mz + share * (a.rotation[0] * my - a.rotation[1] * mx + rho * a.velocity[2]);
    const float xn = qx / qz, yn = qy / qz;
    const float at_u = a.fx * xn + a.cx, at_v = a.fy * yn + a.cy;
    const bool is_inside = (l < count) & (mz > 0.0F) & (qz > 0.0F) & (at_u >= a.min_u) & (at_v >= a.min_v) &
                           (at_u < a.max_u) & (at_v < a.max_v);
    u[l] = is_inside ? at_u : 0.0F, v[l] = is_inside ? at_v : 0.0F;
    inside[l] = is_inside ? 1.0F : 0.0F;

    const float gx = points.gradient_x[l] * a.gain, gy = points.gradient_y[l] * a.gain;
    const float gu = gx * a.fx, gv = gy * a.fy, along = gu * x + gv * y;
    const float J0 = rho * gu, J1 = rho * gv, J2 = -rho * along;
    const float J3 = -y * along - gv, J4 = x * along + gu, J5 = gv * x - gu * y;
    tile.J[0][b][l] = J0, tile.J[1][b][l] = J1, tile.J[2][b][l] = J2;
    tile.J[3][b][l] = J3, tile.J[4][b][l] = J4, tile.J[5][b][l] = J5;
    tile.J[CalibrationEquations::kGain][b][l] = points.intensity[l];
    tile.J[CalibrationEquations::kOffset][b][l] = 1.0F;
    const float share_keyframe = (a.fy * y + a.cy) * a.inverse_height - a.middle;
    const auto moved = [&](int i) {
      return share * a.step_in_keyframe[i] - share_keyframe * a.keyframe_step[i];
    };
    tile.J[CalibrationEquations::kReadout][b][l] =
        J0 * moved(0) + J1 * moved(1) + J2 * moved(2) + J3 * moved(3) + J4 * moved(4) + J5 * moved(5);
    // If the principal point is off by c, the point is seen c farther in the keyframe, and in the frame. So
    // the frame's pixel is off by (1 - A) c, and the keyframe's gradient is the frame's times A, the
    // derivative of a pixel of the frame by the keyframe's pixel at the same depth.
    const float aspect = a.fx / a.fy;
    const float a00 = a.R[0] - xn * a.R[6], a01 = (a.R[1] - xn * a.R[7]) * aspect;
    const float a10 = (a.R[3] - yn * a.R[6]) / aspect, a11 = a.R[4] - yn * a.R[7];
    const float inverse = qz / (a00 * a11 - a01 * a10);
    tile.J[CalibrationEquations::kPrincipalPoint][b][l] =
        a.pixel * ((inverse * a11 - 1.0F) * gx - inverse * a10 * gy);
    tile.J[CalibrationEquations::kPrincipalPoint + 1][b][l] =
        a.pixel * ((inverse * a00 - 1.0F) * gy - inverse * a01 * gx);
    const float by_depth = J0 * a.t_in_keyframe[0] + J1 * a.t_in_keyframe[1] + J2 * a.t_in_keyframe[2];
    tile.J[CalibrationEquations::kDepthTilt][b][l] = by_depth * x;
    tile.J[CalibrationEquations::kDepthTilt + 1][b][l] = by_depth * y;
    // Change of brightness by an error of the depth.
    const float slope = gu * a.t[0] + gv * a.t[1] - along * a.t[2];
    variance[l] = a.noise_variance + slope * slope * points.rho_variance[l];
  }
  float value[kLanes];
  sampleBlock(a.image, a.stride, u, v, value);
  for (int l = 0; l < kLanes; ++l) {
    const float brightness = a.gain * points.intensity[l] + a.offset, expected = shown(brightness);
    const float residual = value[l] - expected;
    const bool is_white = (brightness != expected) & (residual * residual <= a.noise_variance);
    const float sigmas = std::abs(residual) / std::sqrt(variance[l]);
    const float robust = sigmas <= a.huber ? 1.0F : a.huber / sigmas;
    tile.weight[b][l] = (inside[l] > 0.0F) & !is_white ? robust / variance[l] : 0.0F;
    tile.residual[b][l] = residual;
  }
  // What is not in view may not be finite.
  for (int i = 0; i < kParameters; ++i) {
    for (int l = 0; l < kLanes; ++l) tile.J[i][b][l] = inside[l] > 0.0F ? tile.J[i][b][l] : 0.0F;
  }
}

RGBD_SFM_FUSION_MULTIVERSION
void addTile(const Tile& tile, LaneSums& __restrict sums) {
  add(tile, sums);
}

/// Adds the points [begin, end).
void accumulate(const Alignment& alignment, const ReferencePoints& points, int begin, int end,
                LaneSums& sums) {
  constexpr int kBlock = kEvery * kLanes;
  Tile tile{};
  for (int first = begin; first < end; first += kTile * kBlock) {
    for (int b = 0; b < kTile; ++b) {
      const int from = first + b * kBlock, count = (end - from + kEvery - 1) / kEvery;
      if (count > 0)
        weigh(alignment, pointsFrom(points, from), std::min(count, kLanes), b, tile);
      else
        std::fill_n(tile.weight[b], kLanes, 0.0F);
    }
    addTile(tile, sums);
  }
}

template <class Vector>
void copyTo(float* to, const Vector& from) {
  for (int i = 0; i < from.size(); ++i) to[i] = static_cast<float>(from(i));
}

Alignment alignmentOf(const AlignmentProblem& problem, const AlignmentResult& aligned,
                      const Vector6& keyframe_step, int level) {
  const cv::Mat_<float>& image = problem.image[level];
  const cv::Rect& seen = problem.image.seen(level);
  const PinholeCamera& camera = problem.reference.points(level).camera;
  const SE3& T = aligned.T_frame_keyframe;
  const Eigen::Matrix3d R = T.rotationMatrix();
  const Vector6 readout = problem.shutter.motion(T).twist;
  const Vector6 step = T.inverse().adjoint() * (T * problem.shutter.T_last_keyframe.inverse()).log();
  Alignment a;
  for (int row = 0; row < 3; ++row) copyTo(a.R + 3 * row, R.row(row));
  copyTo(a.t, T.translation());
  copyTo(a.t_in_keyframe, R.transpose() * T.translation());
  copyTo(a.velocity, readout.head<3>());
  copyTo(a.rotation, readout.tail<3>());
  copyTo(a.step_in_keyframe, step);
  copyTo(a.keyframe_step, keyframe_step);
  a.fx = static_cast<float>(camera.fx), a.fy = static_cast<float>(camera.fy);
  a.cx = static_cast<float>(camera.cx), a.cy = static_cast<float>(camera.cy);
  a.inverse_height = 1.0F / static_cast<float>(image.rows);
  a.middle = 0.5F - 0.5F * a.inverse_height;
  a.gain = static_cast<float>(aligned.photometry.brightness.gain);
  a.offset = static_cast<float>(aligned.photometry.brightness.offset);
  a.pixel = std::ldexp(1.0F, -level);
  a.min_u = static_cast<float>(seen.x), a.min_v = static_cast<float>(seen.y);
  a.max_u = static_cast<float>(seen.br().x - 1), a.max_v = static_cast<float>(seen.br().y - 1);
  a.noise_variance = 2.0F * problem.options.image_noise * problem.options.image_noise;
  a.huber = problem.options.huber_threshold;
  a.image = image[0];
  a.stride = static_cast<int>(image.step1());
  return a;
}

}  // namespace

CalibrationEquations calibrationEquations(const AlignmentProblem& problem, const AlignmentResult& aligned,
                                          const Vector6& keyframe_step) {
  const int level = problem.options.middleLevel();
  const ReferencePoints& points = problem.reference.points(level);
  const Alignment alignment = alignmentOf(problem, aligned, keyframe_step, level);
  const int length = kEvery * paddedToLanes(points.count / (kEvery * NormalEquations::kStrips) + 1);
  CalibrationEquations equations;
  auto part = equations.strips.begin();
  for (int begin = 0; begin < points.count; begin += length) {
    LaneSums sums{};
    accumulate(alignment, points, begin, std::min(begin + length, points.count), sums);
    CalibrationEquations::Part& strip = *part++;
    addUp(sums, strip.H, strip.g);
    strip.g = -strip.g;
    strip.share = points.shareInMiddle(begin, begin + length);
    equations.H += strip.H;
    equations.g += strip.g;
  }
  return equations;
}

}  // namespace rgbd_sfm_fusion
