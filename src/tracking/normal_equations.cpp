// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "rgbd_sfm_fusion/sampling.h"
#include "rgbd_sfm_fusion/tracking/direct_alignment.h"
#include "rgbd_sfm_fusion/tracking/equation_tile.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kParameters = NormalEquations::Vector::RowsAtCompileTime;

/// The warp, as a block's lanes use it.
struct Warp {
  float R[9], t[3];                // row-major T_frame_keyframe
  float variance_t[3];             // the translation by which depth's variance counts
  float velocity[3], rotation[3];  // motion during the readout
  float inverse_height, middle;    // share of the readout at v: v * inverse_height - middle
  float fx, fy, cx, cy;
  float gain, offset;
  float min_u, min_v;    // [px] of the part that the camera has seen
  float max_u, max_v;    // [px] a pixel beyond has no neighbour to interpolate with
  float noise_variance;  // of a residual [grey levels²]
  float good_variance;   // added to a residual's variance, to judge whether it is good
  float huber;           // [σ]
  float depth_share;     // TrackingReference::independent_share
  const float* image;
  int stride;
};

using Tile = EquationTile<kParameters>;

/// Sums over points, per lane.
struct LaneSums {
  EquationSums<kParameters> equations;
  float cost[kLanes];
  float in_view[kLanes];
  float white[kLanes];
  float judged[kLanes];
  float good[kLanes];
  float bounded[kLanes];
};

/// Weighs a block of points from `base` on, as block `b` of the tile.
__attribute__((always_inline)) inline void weigh(const Warp& warp, const ReferencePoints& points, int base,
                                                 int b, Tile& __restrict tile, LaneSums& __restrict sums) {
  const float* __restrict x = points.x.data() + base;
  const float* __restrict y = points.y.data() + base;
  const float* __restrict rho = points.inverse_depth.data() + base;
  const float* __restrict rho_variance = points.inverse_depth_variance.data() + base;
  const float* __restrict intensity = points.intensity.data() + base;
  const float* __restrict gradient_x = points.gradient_x.data() + base;
  const float* __restrict gradient_y = points.gradient_y.data() + base;

  const int points_left = points.count - base;
  float pixel_u[kLanes], pixel_v[kLanes], variance[kLanes], inside[kLanes];
  float depth_by_residual[kLanes];  // covariance of the residual and what is independent in the depth's error
  for (int l = 0; l < kLanes; ++l) {
    const float mx = warp.R[0] * x[l] + warp.R[1] * y[l] + warp.R[2] + rho[l] * warp.t[0];
    const float my = warp.R[3] * x[l] + warp.R[4] * y[l] + warp.R[5] + rho[l] * warp.t[1];
    const float mz = warp.R[6] * x[l] + warp.R[7] * y[l] + warp.R[8] + rho[l] * warp.t[2];
    // The point moves on by s d until its own row v is read, s = v / height - ½; s moves v in turn.
    const float dx = warp.rotation[1] * mz - warp.rotation[2] * my + rho[l] * warp.velocity[0];
    const float dy = warp.rotation[2] * mx - warp.rotation[0] * mz + rho[l] * warp.velocity[1];
    const float dz = warp.rotation[0] * my - warp.rotation[1] * mx + rho[l] * warp.velocity[2];
    const float inverse_mz = 1.0F / mz, yn_middle = my * inverse_mz;
    const float s_middle = (warp.fy * yn_middle + warp.cy) * warp.inverse_height - warp.middle;
    const float s_rate = warp.fy * (dy - yn_middle * dz) * inverse_mz * warp.inverse_height;
    const float s = s_middle * (1.0F + s_rate + s_rate * s_rate);  // s_middle / (1 - s_rate), |s_rate| << 1
    const float qx = mx + s * dx, qy = my + s * dy, qz = mz + s * dz;
    const float inverse_z = 1.0F / qz;
    const float xn = qx * inverse_z, yn = qy * inverse_z;
    const float u = warp.fx * xn + warp.cx, v = warp.fy * yn + warp.cy;
    const bool is_inside = (l < points_left) & (qz > 0.05F) & (u >= warp.min_u) & (v >= warp.min_v) &
                           (u < warp.max_u) & (v < warp.max_v);
    pixel_u[l] = is_inside ? u : 0.0F;
    pixel_v[l] = is_inside ? v : 0.0F;
    inside[l] = is_inside ? 1.0F : 0.0F;
    // Change of brightness by an error of the depth: gradient times the motion of the pixel with ρ.
    const float slope = gradient_x[l] * warp.fx * (warp.variance_t[0] - xn * warp.variance_t[2]) +
                        gradient_y[l] * warp.fy * (warp.variance_t[1] - yn * warp.variance_t[2]);
    const float slope_z = is_inside ? slope * inverse_z : 0.0F;
    variance[l] = warp.noise_variance + slope_z * slope_z * rho_variance[l];
    depth_by_residual[l] = warp.depth_share * slope_z * rho_variance[l];
  }
  float value[kLanes];
  sampleBlock(warp.image, warp.stride, pixel_u, pixel_v, value);
  for (int l = 0; l < kLanes; ++l) {
    const float brightness = warp.gain * intensity[l] + warp.offset, expected = shown(brightness);
    const float residual = value[l] - expected;
    // White that stays white says nothing of the motion.
    const bool is_white = (brightness != expected) & (residual * residual <= warp.noise_variance);
    sums.white[l] += is_white ? inside[l] : 0.0F;
    inside[l] = is_white ? 0.0F : inside[l];
    const float information = 1.0F / variance[l];
    const float squared = residual * residual * information;
    const float sigmas = std::sqrt(squared);
    const bool inlier = sigmas <= warp.huber;
    const float robust = inlier ? 1.0F : warp.huber / sigmas;
    tile.residual[b][l] = residual;
    tile.weight[b][l] = inside[l] * robust * information;
    sums.cost[l] += inside[l] * (inlier ? 0.5F * squared : warp.huber * (sigmas - 0.5F * warp.huber));
    sums.in_view[l] += inside[l];
    // A point of which its depth leaves open where it is fits everywhere, and counts little.
    const float judged = inside[l] * warp.noise_variance * information;
    sums.judged[l] += judged;
    sums.good[l] += residual * residual < 9.0F * (variance[l] + warp.good_variance) ? judged : 0.0F;
    sums.bounded[l] += judged * lesser(residual * residual / warp.noise_variance, warp.huber * warp.huber);

    const float gu = gradient_x[l] * warp.gain * warp.fx, gv = gradient_y[l] * warp.gain * warp.fy;
    const float along = gu * x[l] + gv * y[l];
    // The derivative by the translation is that at the most probable depth, given the residual. At the depth
    // as it was, its error is in derivative and residual alike, and each motion is found too short.
    const float probable_rho = rho[l] - depth_by_residual[l] * robust * information * residual;
    tile.J[0][b][l] = probable_rho * gu;
    tile.J[1][b][l] = probable_rho * gv;
    tile.J[2][b][l] = -probable_rho * along;
    tile.J[3][b][l] = -y[l] * along - gv;
    tile.J[4][b][l] = x[l] * along + gu;
    tile.J[5][b][l] = gv * x[l] - gu * y[l];
    tile.J[6][b][l] = intensity[l];
    tile.J[7][b][l] = 1.0F;
  }
}

/// Adds the normal equations of the points [begin, end), a multiple of kLanes.
RGBD_SFM_FUSION_MULTIVERSION
void accumulate(const Warp& warp, const ReferencePoints& points, int begin, int end,
                LaneSums& __restrict sums) {
  Tile tile{};
  for (int base = begin; base < end; base += kTile * kLanes) {
    const int blocks = std::min(kTile, (end - base) / kLanes);
    for (int b = 0; b < blocks; ++b) weigh(warp, points, base + b * kLanes, b, tile, sums);
    for (int b = blocks; b < kTile; ++b) std::fill_n(tile.weight[b], kLanes, 0.0F);
    add(tile, sums.equations);
  }
}

}  // namespace

double pointsThatCountAsOne(const AlignmentProblem& problem, int points_on_level) {
  const int points = problem.reference.points(problem.options.finest_level).count;
  return 1.0 + (problem.photometry.alike - 1.0) * points_on_level / std::max(points, 1);
}

NormalEquations linearise(const AlignmentProblem& problem, int level, const SE3& T_frame_keyframe,
                          const Eigen::Vector3d& variance_translation) {
  const ReferencePoints& points = problem.reference.points(level);
  const cv::Mat_<float>& image = problem.image[level];
  const cv::Rect& seen = problem.image.seen(level);
  Warp warp;
  const Eigen::Matrix<float, 3, 3, Eigen::RowMajor> R = T_frame_keyframe.rotationMatrix().cast<float>();
  const Eigen::Vector3f t = T_frame_keyframe.translation().cast<float>();
  std::copy(R.data(), R.data() + 9, warp.R);
  std::copy(t.data(), t.data() + 3, warp.t);
  const Eigen::Vector3f variance_t = variance_translation.cast<float>();
  std::copy(variance_t.data(), variance_t.data() + 3, warp.variance_t);
  const Eigen::Matrix<float, 6, 1> readout = problem.shutter.motion(T_frame_keyframe).twist.cast<float>();
  std::copy(readout.data(), readout.data() + 3, warp.velocity);
  std::copy(readout.data() + 3, readout.data() + 6, warp.rotation);
  warp.inverse_height = 1.0F / static_cast<float>(image.rows);
  warp.middle = 0.5F - 0.5F * warp.inverse_height;
  warp.fx = static_cast<float>(points.camera.fx), warp.fy = static_cast<float>(points.camera.fy);
  warp.cx = static_cast<float>(points.camera.cx), warp.cy = static_cast<float>(points.camera.cy);
  warp.gain = static_cast<float>(problem.photometry.brightness.gain);
  warp.offset = static_cast<float>(problem.photometry.brightness.offset);
  warp.min_u = static_cast<float>(seen.x), warp.min_v = static_cast<float>(seen.y);
  warp.max_u = static_cast<float>(seen.br().x - 1), warp.max_v = static_cast<float>(seen.br().y - 1);
  const auto noise = static_cast<float>(problem.photometry.noise);
  warp.noise_variance = 2.0F * noise * noise;
  warp.good_variance =
      greater(2.0F * problem.options.image_noise * problem.options.image_noise - warp.noise_variance, 0.0F);
  warp.huber = problem.options.huber_threshold;
  warp.image = image[0];
  warp.depth_share = problem.reference.independent_share;
  warp.stride = static_cast<int>(image.step1());

  NormalEquations equations;
  // Points come row by row, so that a chunk of them is a strip of the image. Single precision holds over a
  // thousand blocks; the strips are summed in double precision.
  // Only those of the level that alignment ends on tell anything. A coarser level has fewer, with as many
  // points.
  const int coarser = 2 * std::max(level - problem.options.finest_level, 0);
  const int strips = std::max(NormalEquations::kStrips >> coarser, 1);
  const int end = paddedToLanes(points.count), length = paddedToLanes(end / strips + 1);
  auto part = equations.strips.begin();
  for (int begin = 0; begin < end; begin += length) {
    LaneSums sums{};
    accumulate(warp, points, begin, std::min(begin + length, end), sums);
    NormalEquations::Part& strip = *part++;
    addUp(sums.equations, strip.H, strip.g);
    strip.share = points.shareInMiddle(begin, begin + length);
    equations.H += strip.H;
    equations.g += strip.g;
    equations.cost += total(sums.cost);
    equations.in_view += total(sums.in_view);
    equations.white += total(sums.white);
    equations.judged += total(sums.judged);
    equations.good += total(sums.good);
    equations.bounded += total(sums.bounded);
  }
  if (problem.depth.exists()) {
    equations.depth = depthEquations(problem.depth, T_frame_keyframe,
                                     T_frame_keyframe * problem.shutter.T_last_keyframe.inverse());
    const double alike = pointsThatCountAsOne(problem, points.count);
    equations.H.topLeftCorner<6, 6>() += alike * equations.depth.H;
    equations.g.head<6>() += alike * equations.depth.g;
    equations.cost += alike * equations.depth.cost;
  }
  return equations;
}

}  // namespace rgbd_sfm_fusion
