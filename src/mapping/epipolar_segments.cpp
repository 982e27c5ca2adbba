// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/epipolar_segments.h"

#include <algorithm>
#include <cmath>

#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr float kMinCosine = 0.3F;                       // between gradient and epipolar line
constexpr float kMinStretch = 0.5F, kMaxStretch = 2.0F;  // of the pattern between the images
constexpr float kSubpixelVariance = 0.05F * 0.05F;       // [px²] interpolation of a sampled image

/// The pair's geometry: pixel (u, v) at inverse depth ρ projects to H (u, v, 1) + ρ b.
struct PairGeometry {
  float H[9], b[3];  // row-major K R K⁻¹, and K t
};

PairGeometry pairGeometry(const PinholeCamera& camera, const SE3& T_view_keyframe) {
  Eigen::Matrix3d K = Eigen::Matrix3d::Identity();
  K(0, 0) = camera.fx, K(1, 1) = camera.fy, K(0, 2) = camera.cx, K(1, 2) = camera.cy;
  const Eigen::Matrix<float, 3, 3, Eigen::RowMajor> H =
      (K * T_view_keyframe.rotationMatrix() * K.inverse()).cast<float>();
  const Eigen::Vector3f b = (K * T_view_keyframe.translation()).cast<float>();
  PairGeometry geometry;
  std::copy(H.data(), H.data() + 9, geometry.H);
  std::copy(b.data(), b.data() + 3, geometry.b);
  return geometry;
}

constexpr int kBandRows = 16;  // of the keyframe, that are taken as read out at once

/// The pair's geometry for each band of the keyframe's rows. When a row of the view is read out that shows a
/// band depends on its depth; that of a typical pixel in the middle is good enough.
std::vector<PairGeometry> bandGeometry(const PinholeCamera& camera, const StereoView& view,
                                       double inverse_depth) {
  std::vector<PairGeometry> bands;
  for (int row = 0; row < camera.height; row += kBandRows) {
    const double v = row + 0.5 * (kBandRows - 1);
    const SE3 T_view_row =
        view.T_view_keyframe * view.keyframe_motion.T_row_image(v, camera.height).inverse();
    const double v_view =
        camera.project(T_view_row * camera.backProject(camera.cx, v, 1.0 / inverse_depth)).y();
    bands.push_back(pairGeometry(camera, view.motion.T_row_image(v_view, camera.height) * T_view_row));
  }
  return bands;
}

struct PlanLimits {
  float max_inverse_depth, min_u, min_v, max_u, max_v, max_length, min_gradient_squared, image_variance,
      epipolar_variance, observe_below_squared;
};

/// Segments of a block of candidates, one array per quantity as in EpipolarSegment.
struct SegmentBlock {
  float u[kLanes], v[kLanes], du[kLanes], dv[kLanes], eu[kLanes], ev[kLanes];
  float inverse_depth[kLanes], rate[kLanes], z[kLanes], z_rate[kLanes], geometric_variance[kLanes];
  int before[kLanes], after[kLanes];  // after < 0: not to be searched
};

RGBD_SFM_FUSION_MULTIVERSION
void planBlock(const PairGeometry& g, const PlanLimits& limits, const StereoCandidates::Block& candidates,
               const float* estimate_variances, const float* prior_means, const float* prior_variances,
               SegmentBlock& __restrict out) {
  float prior_mean[kLanes], prior_variance[kLanes], estimate_variance[kLanes];
  for (int l = 0; l < kLanes; ++l) prior_mean[l] = prior_means[candidates.pixel[l]];
  for (int l = 0; l < kLanes; ++l) prior_variance[l] = prior_variances[candidates.pixel[l]];
  for (int l = 0; l < kLanes; ++l) estimate_variance[l] = estimate_variances[candidates.pixel[l]];
  const PairGeometry h = g;
  const PlanLimits limit = limits;
  float is_possible[kLanes], to_near_end[kLanes], to_far_end[kLanes];
  for (int l = 0; l < kLanes; ++l) {
    const float u = candidates.u[l], v = candidates.v[l];
    const float gradient_x = candidates.gradient_x[l], gradient_y = candidates.gradient_y[l];
    const bool has_prior = prior_mean[l] > 0.0F;
    const float reach = 2.0F * std::sqrt(has_prior ? prior_variance[l] : 0.0F);
    const float near_prior = lesser(prior_mean[l] + reach, limit.max_inverse_depth);
    const float near = has_prior ? near_prior : limit.max_inverse_depth;
    const float far = has_prior ? greater(prior_mean[l] - reach, 0.0F) : 0.0F;
    const float centre = 0.5F * (near + far);

    // H (u, v, 1) + ρ b, at the centre and at both ends.
    const float hx = h.H[0] * u + h.H[1] * v + h.H[2];
    const float hy = h.H[3] * u + h.H[4] * v + h.H[5];
    const float hz = h.H[6] * u + h.H[7] * v + h.H[8];
    const float z = hz + centre * h.b[2], z_near = hz + near * h.b[2], z_far = hz + far * h.b[2];
    const float inverse_z = 1.0F / z, inverse_z_near = 1.0F / z_near, inverse_z_far = 1.0F / z_far;
    const float cu = (hx + centre * h.b[0]) * inverse_z, cv = (hy + centre * h.b[1]) * inverse_z;
    const float rate_u = (h.b[0] - cu * h.b[2]) * inverse_z, rate_v = (h.b[1] - cv * h.b[2]) * inverse_z;
    const float rate = std::sqrt(rate_u * rate_u + rate_v * rate_v);
    const float du = rate_u / rate, dv = rate_v / rate;
    const float to_near =
        ((hx + near * h.b[0]) * inverse_z_near - cu) * du + ((hy + near * h.b[1]) * inverse_z_near - cv) * dv;
    const float to_far =
        (cu - (hx + far * h.b[0]) * inverse_z_far) * du + (cv - (hy + far * h.b[1]) * inverse_z_far) * dv;

    // The keyframe's epipolar line: the step that moves the projection by one pixel at this depth.
    const float m00 = (h.H[0] - cu * h.H[6]) * inverse_z, m01 = (h.H[1] - cu * h.H[7]) * inverse_z;
    const float m10 = (h.H[3] - cv * h.H[6]) * inverse_z, m11 = (h.H[4] - cv * h.H[7]) * inverse_z;
    const float determinant = m00 * m11 - m01 * m10;
    const float eu = (m11 * du - m01 * dv) / determinant, ev = (m00 * dv - m10 * du) / determinant;
    const float stretch_squared = eu * eu + ev * ev;
    const float gradient_squared = gradient_x * gradient_x + gradient_y * gradient_y;
    const float along = gradient_x * eu + gradient_y * ev;
    const float cosine_squared = along * along / (gradient_squared * stretch_squared);
    const float geometric = limit.epipolar_variance / cosine_squared + kSubpixelVariance;
    const float photometric = limit.image_variance / (2.0F * along * along);
    const float predicted_variance = (geometric + photometric) / (rate * rate);

    const bool possible =
        (z_near > 0.2F) & (z_far > 0.2F) & (rate > 1e-3F) & (to_far >= 0.0F) & (to_near >= 0.0F) &
        (to_far + to_near <= limit.max_length) & (cosine_squared >= kMinCosine * kMinCosine) &
        (along * along >= limit.min_gradient_squared) & (stretch_squared >= kMinStretch * kMinStretch) &
        (stretch_squared <= kMaxStretch * kMaxStretch) &
        (predicted_variance < limit.observe_below_squared * estimate_variance[l]);
    out.u[l] = cu, out.v[l] = cv, out.du[l] = du, out.dv[l] = dv, out.eu[l] = eu, out.ev[l] = ev;
    out.inverse_depth[l] = centre, out.rate[l] = rate, out.z[l] = z, out.z_rate[l] = h.b[2];
    out.geometric_variance[l] = geometric;
    is_possible[l] = possible ? 1.0F : 0.0F;
    to_near_end[l] = possible ? to_near : 0.0F;
    to_far_end[l] = possible ? to_far : 0.0F;
  }
  for (int l = 0; l < kLanes; ++l) {
    // At least one step either side, to see whether the best is a minimum.
    const int steps_before = static_cast<int>(to_far_end[l] + 1.5F),
              steps_after = static_cast<int>(to_near_end[l] + 1.5F);
    const float low = static_cast<float>(-steps_before - kPatternRadius - 2);
    const float high = static_cast<float>(steps_after + kPatternRadius + 2);
    const float u0 = out.u[l] + low * out.du[l], u1 = out.u[l] + high * out.du[l];
    const float v0 = out.v[l] + low * out.dv[l], v1 = out.v[l] + high * out.dv[l];
    const bool inside = (is_possible[l] > 0.0F) & (u0 >= limit.min_u) & (u1 >= limit.min_u) &
                        (v0 >= limit.min_v) & (v1 >= limit.min_v) & (u0 < limit.max_u) & (u1 < limit.max_u) &
                        (v0 < limit.max_v) & (v1 < limit.max_v);
    out.before[l] = steps_before;
    out.after[l] = inside ? steps_after : -1;
  }
}

EpipolarSegment segment(const SegmentBlock& s, const StereoCandidates::Block& candidates, int l) {
  return {candidates.pixel[l],
          candidates.u[l],
          candidates.v[l],
          s.u[l],
          s.v[l],
          s.du[l],
          s.dv[l],
          s.eu[l],
          s.ev[l],
          s.inverse_depth[l],
          s.rate[l],
          s.z[l],
          s.z_rate[l],
          s.geometric_variance[l],
          s.before[l],
          s.after[l]};
}

}  // namespace

void EpipolarSegments::plan(const PinholeCamera& camera, const StereoCandidates& candidates,
                            const StereoView& view, const InverseDepthImage& estimate,
                            const InverseDepthImage& prior, float max_inverse_depth,
                            const MappingOptions& options) {
  PlanLimits limits;
  limits.max_inverse_depth = max_inverse_depth;
  limits.min_u = static_cast<float>(view.seen.x), limits.min_v = static_cast<float>(view.seen.y);
  limits.max_u = static_cast<float>(view.seen.br().x - 1);
  limits.max_v = static_cast<float>(view.seen.br().y - 1);
  limits.max_length = static_cast<float>(options.max_search_length);
  limits.min_gradient_squared = 0.25F * options.min_gradient * options.min_gradient;
  limits.image_variance = 2.0F * options.image_noise * options.image_noise;
  limits.epipolar_variance = options.epipolar_noise * options.epipolar_noise;
  limits.observe_below_squared = options.observe_below * options.observe_below;
  const std::vector<PairGeometry> bands =
      bandGeometry(camera, view, static_cast<double>(options.min_depth * max_inverse_depth));
  by_length_.resize(static_cast<std::size_t>(options.max_search_length) + 4);
  for (auto& list : by_length_) list.clear();
  SegmentBlock block;
  for (const StereoCandidates::Block& pixels : candidates.blocks) {
    const PairGeometry& geometry = bands[static_cast<std::size_t>(pixels.v[kLanes / 2]) / kBandRows];
    planBlock(geometry, limits, pixels, estimate.variance[0], prior.mean[0], prior.variance[0], block);
    for (int l = 0; l < kLanes; ++l) {
      if (block.after[l] < 0) continue;
      by_length_[static_cast<std::size_t>(block.before[l] + block.after[l])].push_back(
          segment(block, pixels, l));
    }
  }
}

}  // namespace rgbd_sfm_fusion
