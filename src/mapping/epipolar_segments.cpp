// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/epipolar_segments.h"

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

// An observation with three times the estimate's 1/σ² makes 1/σ² four times as large, and so halves σ.
constexpr float kObserveBelowSquared = 1.0F / 3.0F;

constexpr auto kBorder = static_cast<float>(StereoCandidates::kBorder);

/// @param by_readout  [1/s] twist of T_view_keyframe per readout time, in the view's axes
PairGeometry pairGeometry(const PinholeCamera& camera, const SE3& T_view_keyframe, const Vector6& by_readout,
                          const Matrix6& covariance) {
  using RowMajor = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;
  Eigen::Matrix3d K = Eigen::Matrix3d::Identity();
  K(0, 0) = camera.fx, K(1, 1) = camera.fy, K(0, 2) = camera.cx, K(1, 2) = camera.cy;
  const Eigen::Matrix3d R = T_view_keyframe.rotationMatrix();
  const Eigen::Vector3d t = T_view_keyframe.translation(), turn = by_readout.tail<3>();
  const RowMajor H = (K * R * K.inverse()).cast<float>();
  const Eigen::Vector3f b = (K * t).cast<float>();
  PairGeometry geometry;
  std::copy(H.data(), H.data() + 9, geometry.H);
  std::copy(b.data(), b.data() + 3, geometry.b);
  const Eigen::Matrix3d turned = -R.colwise().cross(turn);
  const RowMajor dH = (K * turned * K.inverse()).cast<float>();
  const Eigen::Vector3f db = (K * (by_readout.head<3>() + turn.cross(t))).cast<float>();
  std::copy(dH.data(), dH.data() + 9, geometry.dH);
  std::copy(db.data(), db.data() + 3, geometry.db);
  geometry.fx = static_cast<float>(camera.fx), geometry.fy = static_cast<float>(camera.fy);
  geometry.cx = static_cast<float>(camera.cx), geometry.cy = static_cast<float>(camera.cy);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j)
      geometry.covariance[i][j] = static_cast<float>(i == j ? covariance(i, i) : 2.0 * covariance(i, j));
  }
  return geometry;
}

/// The pair's geometry for a band of the keyframe's rows, which is taken as read out at once. The view's row
/// that shows the band, and so the time of its readout, depends on depth. A typical depth in the middle is
/// good enough.
PairGeometry ofBand(const PinholeCamera& camera, const StereoView& view, std::size_t band,
                    double inverse_depth) {
  constexpr int kRows = RowBands::kRows;
  const int height = camera.height;
  const ReadoutMotion motion{view.readout_time * view.velocity},
      keyframe_motion{view.readout_time * view.keyframe_velocity};
  const double v = static_cast<double>(band) * kRows + 0.5 * (kRows - 1);
  const SE3 T_view_row = view.T_view_keyframe * keyframe_motion.T_row_image(v, height).inverse();
  const double v_view =
      camera.project(T_view_row * camera.backProject(camera.cx, v, 1.0 / inverse_depth)).y();
  const SE3 T_row_row = motion.T_row_image(v_view, height) * T_view_row;
  const Vector6 by_readout =
      ReadoutMotion::share(v_view, height) * view.velocity -
      ReadoutMotion::share(v, height) * Vector6(T_row_row.adjoint() * view.keyframe_velocity);
  return pairGeometry(camera, T_row_row, by_readout, view.covariance);
}

/// Corners of a part of an image, between its outermost pixels.
std::array<Eigen::Vector2f, 4> corners(float min_u, float min_v, float max_u, float max_v) {
  return {Eigen::Vector2f(min_u, min_v), Eigen::Vector2f(max_u, min_v), Eigen::Vector2f(min_u, max_v),
          Eigen::Vector2f(max_u, max_v)};
}

/// @param first, last  rows of the band in the keyframe
VarianceBound boundOf(const PairGeometry& g, const EpipolarPlan::Limits& limits, float width, float first,
                      float last) {
  using RowMajor = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;
  const RowMajor H = Eigen::Map<const RowMajor>(g.H);
  const Eigen::Vector3f b = Eigen::Map<const Eigen::Vector3f>(g.b);
  // The depth ratio z = H (u, v, 1) + ρ b, in z, is linear in all three.
  const float step = limits.max_inverse_depth * b.z();
  float least_z = std::numeric_limits<float>::max(), most_z = 0.0F;
  for (const Eigen::Vector2f& corner : corners(0.0F, first, width - 1.0F, last)) {
    const float z = H.row(2).dot(corner.homogeneous());
    least_z = std::min({least_z, z, z + step});
    most_z = std::max({most_z, z, z + step});
  }
  // A projection moves by (b - (u, v, 1) b_z) / z per inverse depth. The norm is convex.
  float most_rate = 0.0F;
  for (const Eigen::Vector2f& corner : corners(limits.min_u, limits.min_v, limits.max_u, limits.max_v))
    most_rate = std::max(most_rate, (b.head<2>() - b.z() * corner).norm());
  most_rate = least_z > 0.0F ? most_rate / least_z : std::numeric_limits<float>::infinity();
  // Derivative of the projection (u', v') by (u, v): (H - (u', v') H_z) / z. Its smallest singular value is
  // least in the middle of the view, but for the distance from there.
  const Eigen::Vector2f least(limits.min_u, limits.min_v), most(limits.max_u, limits.max_v);
  const Eigen::Matrix2f in_middle = H.topLeftCorner<2, 2>() - 0.5F * (least + most) * H.row(2).head<2>();
  const float singular =
      in_middle.jacobiSvd().singularValues()(1) - 0.5F * (most - least).norm() * H.row(2).head<2>().norm();
  const float in_keyframe = (kBorder - 1.0F) / kPatternRadius;  // the pattern has to stay in it
  const float stretch = singular > 0.0F ? std::min(most_z / singular, in_keyframe) : in_keyframe;
  const Eigen::Vector3f epipole = H.inverse() * b;
  const float above_rounding = 1.0F - std::sqrt(std::numeric_limits<float>::epsilon());
  VarianceBound bound;
  std::copy(epipole.data(), epipole.data() + 3, bound.epipole);
  bound.most_rate_squared = most_rate * most_rate;
  bound.photometric = above_rounding * limits.image_variance / (2.0F * stretch * stretch);
  bound.epipolar = above_rounding * limits.epipolar_variance;
  return bound;
}

/// Tests the geometric and the predicted variance as planBlock() does, with the least that they can be at any
/// depth in view. Padding has no gradient, and is never marked.
RGBD_SFM_FUSION_MULTIVERSION
void markBlock(const VarianceBound& bound, const EpipolarPlan::Limits& limits,
               const StereoCandidates::Block& candidates, const float* estimate_variances,
               const std::uint8_t* observations, bool* promising) {
  const VarianceBound b = bound;
  float needed[kLanes];  // [1/unit²] variance that a search has to fall below
  for (int l = 0; l < kLanes; ++l) needed[l] = estimate_variances[candidates.pixel[l]];
  for (int l = 0; l < kLanes; ++l)
    needed[l] *= observations[candidates.pixel[l]] < limits.min_observations ? limits.confirm_below_squared
                                                                             : kObserveBelowSquared;
  int is_promising[kLanes];
  for (int l = 0; l < kLanes; ++l) {
    const float gradient_x = candidates.gradient_x[l], gradient_y = candidates.gradient_y[l];
    const float line_x = b.epipole[0] - b.epipole[2] * candidates.u[l],
                line_y = b.epipole[1] - b.epipole[2] * candidates.v[l];
    const float along = gradient_x * line_x + gradient_y * line_y, squared = along * along;
    const float length_squared = line_x * line_x + line_y * line_y;
    const float gradient_squared = gradient_x * gradient_x + gradient_y * gradient_y;
    const float epipolar = b.epipolar * gradient_squared * length_squared;
    const bool improves =
        epipolar + b.photometric * length_squared < squared * b.most_rate_squared * needed[l];
    is_promising[l] = (epipolar <= squared) & improves ? 1 : 0;
  }
  for (int l = 0; l < kLanes; ++l) promising[l] = is_promising[l] != 0;
}

RGBD_SFM_FUSION_MULTIVERSION
void planBlock(const PairGeometry& g, const EpipolarPlan::Limits& limits,
               const StereoCandidates::Block& candidates, const float* estimate_variances,
               const std::uint8_t* observations, const float* prior_means, const float* prior_variances,
               PlannedSegments& __restrict planned) {
  float prior_mean[kLanes], prior_variance[kLanes], estimate_variance[kLanes];
  for (int l = 0; l < kLanes; ++l) prior_mean[l] = prior_means[candidates.pixel[l]];
  for (int l = 0; l < kLanes; ++l) prior_variance[l] = prior_variances[candidates.pixel[l]];
  for (int l = 0; l < kLanes; ++l) estimate_variance[l] = estimate_variances[candidates.pixel[l]];
  float observe_below[kLanes];
  for (int l = 0; l < kLanes; ++l)
    observe_below[l] = observations[candidates.pixel[l]] < limits.min_observations
                           ? limits.confirm_below_squared
                           : kObserveBelowSquared;
  SegmentBlock& __restrict out = planned.segments;
  const PairGeometry h = g;
  const EpipolarPlan::Limits limit = limits;
  float is_possible[kLanes], to_near_end[kLanes], to_far_end[kLanes], is_known[kLanes];
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
    const float reach_of_pattern = kPatternRadius * std::sqrt(stretch_squared);
    const float gradient_squared = gradient_x * gradient_x + gradient_y * gradient_y;
    const float along = gradient_x * eu + gradient_y * ev;
    const float cosine_squared = along * along / (gradient_squared * stretch_squared);
    float geometric = limit.epipolar_variance / cosine_squared;
    // An error of the pose moves the projection, and the match moves along the line to where brightness is
    // the same again.
    const float in_keyframe_u = (gradient_x * m11 - gradient_y * m10) / (determinant * along),
                in_keyframe_v = (gradient_y * m00 - gradient_x * m01) / (determinant * along);
    const float gu = h.fx * in_keyframe_u, gv = h.fy * in_keyframe_v;
    const float x = (cu - h.cx) / h.fx, y = (cv - h.cy) / h.fy, rho = centre * inverse_z;
    const float along_ray = gu * x + gv * y;
    const float vx = gu * rho, vy = gv * rho, vz = -along_ray * rho;  // by the translation
    const float wx = -y * along_ray - gv, wy = x * along_ray + gu, wz = gv * x - gu * y;  // by the turn
    const auto& c = h.covariance;
    const float of_pose =
        vx * (c[0][0] * vx + c[0][1] * vy + c[0][2] * vz + c[0][3] * wx + c[0][4] * wy + c[0][5] * wz) +
        vy * (c[1][1] * vy + c[1][2] * vz + c[1][3] * wx + c[1][4] * wy + c[1][5] * wz) +
        vz * (c[2][2] * vz + c[2][3] * wx + c[2][4] * wy + c[2][5] * wz) +
        wx * (c[3][3] * wx + c[3][4] * wy + c[3][5] * wz) + wy * (c[4][4] * wy + c[4][5] * wz) +
        wz * c[5][5] * wz;
    geometric += of_pose;
    planned.by_pose[l] = std::sqrt(greater(of_pose, 0.0F)) / rate;
    const float photometric = limit.image_variance / (2.0F * along * along);
    const float predicted_variance = (geometric + photometric) / (rate * rate);

    // The pattern has to stay in the keyframe, and the line's error has to move a match by less than a step
    // of the search.
    const bool possible = (z_near > 0.2F) & (z_far > 0.2F) & (rate > 1e-3F) & (to_far >= 0.0F) &
                          (to_near >= 0.0F) & (to_far + to_near <= limit.max_length) & (geometric <= 1.0F) &
                          (reach_of_pattern + 1.0F <= kBorder) &
                          (predicted_variance < observe_below[l] * estimate_variance[l]);
    out.keyframe_u[l] = u, out.keyframe_v[l] = v;
    out.u[l] = cu, out.v[l] = cv, out.du[l] = du, out.dv[l] = dv, out.eu[l] = eu, out.ev[l] = ev;
    out.inverse_depth[l] = centre, out.rate[l] = rate, out.z[l] = z, out.z_rate[l] = h.b[2];
    out.geometric_variance[l] = geometric;
    // The readout time moves the projection along the line, as the inverse depth does.
    const float dx = h.dH[0] * u + h.dH[1] * v + h.dH[2] + centre * h.db[0];
    const float dy = h.dH[3] * u + h.dH[4] * v + h.dH[5] + centre * h.db[1];
    const float dz = h.dH[6] * u + h.dH[7] * v + h.dH[8] + centre * h.db[2];
    planned.by_readout[l] = ((dx - cu * dz) * du + (dy - cv * dz) * dv) * inverse_z / rate;
    is_known[l] = has_prior ? 1.0F : 0.0F;
    is_possible[l] = possible ? 1.0F : 0.0F;
    to_near_end[l] = possible ? to_near : 0.0F;
    to_far_end[l] = possible ? to_far : 0.0F;
  }
  float possible = 0.0F;
  for (int l = 0; l < kLanes; ++l) possible += is_possible[l];
  if (possible == 0.0F) {
    for (int l = 0; l < kLanes; ++l) out.before[l] = out.after[l] = -1;
    return;
  }
  for (int l = 0; l < kLanes; ++l) {
    // A search takes at least one step to either side, to see whether the best place is a minimum.
    const float to_far = std::floor(to_far_end[l] + 1.5F), to_near = std::floor(to_near_end[l] + 1.5F);
    // The search ends at the edge of the view, with room for the pattern.
    const float du = out.du[l], dv = out.dv[l], u = out.u[l], v = out.v[l];
    const float inverse_du = 1.0F / (std::abs(du) > 1e-6F ? du : 1e-6F);
    const float inverse_dv = 1.0F / (std::abs(dv) > 1e-6F ? dv : 1e-6F);
    const float left = (limit.min_u - u) * inverse_du, right = (limit.max_u - u) * inverse_du;
    const float up = (limit.min_v - v) * inverse_dv, down = (limit.max_v - v) * inverse_dv;
    const float seen_far = std::floor(-greater(lesser(left, right), lesser(up, down)) - kBorder);
    const float seen_near = std::floor(lesser(greater(left, right), greater(up, down)) - kBorder);
    const float before = lesser(to_far, seen_far), after = lesser(to_near, seen_near);
    // If a pixel has a prior, a search in a part of the segment would miss matches in the other part, and
    // that would count against the pixel. Without a prior, at least the middle has to be in view: a small
    // part does not tell whether a match is distinct.
    const bool whole = (before == to_far) & (after == to_near);
    const bool part = (is_known[l] == 0.0F) & (before >= 0.0F) & (after >= 0.0F);
    const bool searched = (is_possible[l] > 0.0F) & (before + after >= 2.0F) & (whole | part);
    out.before[l] = searched ? static_cast<int>(before) : -1;
    out.after[l] = searched ? static_cast<int>(after) : -1;
  }
}

}  // namespace

EpipolarPlan::EpipolarPlan(const PinholeCamera& camera, const StereoView& view, const KnownDepths& known,
                           const MappingOptions& options)
    : camera_(camera),
      view_(view),
      known_(known),
      typical_(static_cast<double>(options.min_depth * known.max_inverse_depth)) {
  limits_.max_inverse_depth = known.max_inverse_depth;
  limits_.min_u = static_cast<float>(view.seen.x), limits_.min_v = static_cast<float>(view.seen.y);
  limits_.max_u = static_cast<float>(view.seen.br().x - 1);
  limits_.max_v = static_cast<float>(view.seen.br().y - 1);
  limits_.max_length = static_cast<float>(options.max_search_length);
  limits_.image_variance = 2.0F * options.image_noise * options.image_noise;
  limits_.epipolar_variance = options.epipolar_noise * options.epipolar_noise;
  limits_.confirm_below_squared = options.confirm_below * options.confirm_below;
  limits_.min_observations = options.min_observations;
}

void EpipolarPlan::setBand(std::size_t band) {
  pair_ = ofBand(camera_, view_, band, typical_);
  const auto first = static_cast<float>(band * RowBands::kRows);
  bound_ = boundOf(pair_, limits_, static_cast<float>(camera_.width), first, first + RowBands::kRows - 1.0F);
}

void EpipolarPlan::markPromising(const StereoCandidates::Block& candidates, bool* promising) const {
  markBlock(bound_, limits_, candidates, known_.estimate.variance[0], known_.observations[0], promising);
}

void EpipolarPlan::plan(const StereoCandidates::Block& candidates, PlannedSegments& planned) const {
  planBlock(pair_, limits_, candidates, known_.estimate.variance[0], known_.observations[0],
            known_.prior.mean[0], known_.prior.variance[0], planned);
}

}  // namespace rgbd_sfm_fusion
