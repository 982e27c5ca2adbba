// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/epipolar_stereo.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kPatternRadius = 2;  // five samples along the line
constexpr int kPattern = 2 * kPatternRadius + 1;
constexpr int kBorder = 7;                               // [px] of the keyframe: room for a stretched pattern
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

// As std::min and std::max, but of values, which compilers turn into vector code.
inline float lesser(float a, float b) {
  return a < b ? a : b;
}
inline float greater(float a, float b) {
  return a > b ? a : b;
}

}  // namespace

void StereoCandidates::collect(const ImageGradient& gradient, const cv::Rect& seen, float min_gradient) {
  const int width = gradient.x.cols, height = gradient.x.rows;
  blocks.resize(static_cast<std::size_t>(paddedToLanes(width * height) / kLanes));
  int n = 0;
  for (int row = seen.y + kBorder; row < seen.br().y - kBorder; ++row) {
    const float *gx = gradient.x[row], *gy = gradient.y[row];
    for (int column = seen.x + kBorder; column < seen.br().x - kBorder; ++column) {
      // Written at every pixel and kept only at some: there is no branch to mispredict.
      Block& block = blocks[static_cast<std::size_t>(n / kLanes)];
      const int lane = n % kLanes;
      block.u[lane] = static_cast<float>(column);
      block.v[lane] = static_cast<float>(row);
      block.gradient_x[lane] = gx[column];
      block.gradient_y[lane] = gy[column];
      block.pixel[lane] = row * width + column;
      n += gx[column] * gx[column] + gy[column] * gy[column] >= min_gradient * min_gradient ? 1 : 0;
    }
  }
  count = n;
  blocks.resize(static_cast<std::size_t>(paddedToLanes(count) / kLanes));
  for (; n < paddedToLanes(count); ++n) {
    Block& block = blocks.back();
    const int lane = n % kLanes;
    block.u[lane] = block.v[lane] = block.gradient_x[lane] = block.gradient_y[lane] = 0.0F;
    block.pixel[lane] = 0;
  }
}

namespace {

RGBD_SFM_FUSION_MULTIVERSION
void planBlock(const PairGeometry& g, const PlanLimits& limits, const StereoCandidates::Block& candidates,
               const float* estimate_variances, const float* prior_means, const float* prior_variances,
               EpipolarSegments& __restrict out) {
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

constexpr int kMaxSamples = 128;  // of a line: the longest segment, and the pattern either side

struct MatchLimits {
  float image_variance;       // [grey levels²] of the difference of two pixels
  float max_square_mismatch;  // mean square difference of a match, over image_variance
  float min_distinctness;
  float gain, offset;
};

struct BlockMatches {
  float inverse_depth[kLanes], variance[kLanes];
  bool matched[kLanes];
};

/// Searches `steps` positions for each of kLanes candidates, whose indices are `chosen`.
RGBD_SFM_FUSION_MULTIVERSION
void matchBlock(SampleBlock sample, const float* keyframe, int keyframe_stride, const float* view,
                int view_stride, const StereoCandidates& candidates,
                const std::vector<EpipolarSegments>& segments, const int* chosen, const MatchLimits& limits,
                BlockMatches& out) {
  EpipolarSegments s;
  float keyframe_u[kLanes], keyframe_v[kLanes];
  for (int l = 0; l < kLanes; ++l) {
    const auto block = static_cast<std::size_t>(chosen[l] / kLanes);
    const int lane = chosen[l] % kLanes;
    const EpipolarSegments& from = segments[block];
    s.u[l] = from.u[lane], s.v[l] = from.v[lane], s.du[l] = from.du[lane], s.dv[l] = from.dv[lane];
    s.eu[l] = from.eu[lane], s.ev[l] = from.ev[lane], s.inverse_depth[l] = from.inverse_depth[lane];
    s.rate[l] = from.rate[lane], s.z[l] = from.z[lane], s.z_rate[l] = from.z_rate[lane];
    s.geometric_variance[l] = from.geometric_variance[lane];
    s.before[l] = from.before[lane], s.after[l] = from.after[lane];
    keyframe_u[l] = candidates.blocks[block].u[lane], keyframe_v[l] = candidates.blocks[block].v[lane];
  }
  float u[kLanes], v[kLanes], before[kLanes], last[kLanes];
  int steps = 0;
  for (int l = 0; l < kLanes; ++l) steps = std::max(steps, s.before[l] + s.after[l] + 1);
  for (int l = 0; l < kLanes; ++l) {
    before[l] = static_cast<float>(s.before[l]);
    last[l] = static_cast<float>(s.before[l] + s.after[l]);
    u[l] = s.u[l] - before[l] * s.du[l], v[l] = s.v[l] - before[l] * s.dv[l];
  }
  float pattern[kPattern][kLanes];
  for (int m = 0; m < kPattern; ++m) {
    const auto step = static_cast<float>(m - kPatternRadius);
    float pu[kLanes], pv[kLanes];
    for (int l = 0; l < kLanes; ++l)
      pu[l] = keyframe_u[l] + step * s.eu[l], pv[l] = keyframe_v[l] + step * s.ev[l];
    sample(keyframe, keyframe_stride, pu, pv, pattern[m]);
    for (int l = 0; l < kLanes; ++l) pattern[m][l] = limits.gain * pattern[m][l] + limits.offset;
  }

  // Line samples from one before the first pattern to one behind the last. A shorter segment's lanes stay
  // on their own last sample, which is inside the image.
  constexpr int kLead = kPatternRadius + 1;
  float line[kMaxSamples][kLanes];
  for (int k = 0; k < steps + 2 * kLead; ++k) {
    float su[kLanes], sv[kLanes];
    for (int l = 0; l < kLanes; ++l) {
      const float position = lesser(static_cast<float>(k), last[l] + 2.0F * kLead) - kLead;
      su[l] = u[l] + position * s.du[l];
      sv[l] = v[l] + position * s.dv[l];
    }
    sample(view, view_stride, su, sv, line[k]);
  }

  float error[kMaxSamples][kLanes], best[kLanes], best_step[kLanes];
  for (int l = 0; l < kLanes; ++l) best[l] = 1e30F, best_step[l] = 0.0F;
  for (int j = 0; j < steps; ++j) {
    const auto step = static_cast<float>(j);
    for (int l = 0; l < kLanes; ++l) {
      float sum = 0.0F;
      for (int m = 0; m < kPattern; ++m) {
        const float difference = line[j + 1 + m][l] - pattern[m][l];
        sum += difference * difference;
      }
      sum = step <= last[l] ? sum : 1e30F;
      error[j][l] = sum;
      best_step[l] = sum < best[l] ? step : best_step[l];
      best[l] = lesser(sum, best[l]);
    }
  }
  float second[kLanes];
  for (int l = 0; l < kLanes; ++l) second[l] = 1e30F;
  for (int j = 0; j < steps; ++j) {
    const auto step = static_cast<float>(j);
    for (int l = 0; l < kLanes; ++l) {
      const bool apart = std::abs(step - best_step[l]) > 1.5F;
      second[l] = apart ? lesser(second[l], error[j][l]) : second[l];
    }
  }

  // Gauss–Newton for the rest of a pixel: once with the samples at hand, once with new ones.
  float slope[kPattern][kLanes], information[kLanes], shift[kLanes], su[kLanes], sv[kLanes];
  for (int l = 0; l < kLanes; ++l) {
    const int first = static_cast<int>(best_step[l]) + 1;
    float square = 0.0F, product = 0.0F;
    for (int m = 0; m < kPattern; ++m) {
      const float derivative = 0.5F * (line[first + m + 1][l] - line[first + m - 1][l]);
      slope[m][l] = derivative;
      square += derivative * derivative;
      product += derivative * (pattern[m][l] - line[first + m][l]);
    }
    information[l] = greater(square, 1e-3F);
    shift[l] = lesser(greater(product / information[l], -1.0F), 1.0F);
  }
  float residual[kPattern][kLanes];
  for (int m = 0; m < kPattern; ++m) {
    for (int l = 0; l < kLanes; ++l) {
      const float position = best_step[l] + shift[l] + static_cast<float>(m - kPatternRadius);
      su[l] = u[l] + position * s.du[l];
      sv[l] = v[l] + position * s.dv[l];
    }
    sample(view, view_stride, su, sv, residual[m]);
    for (int l = 0; l < kLanes; ++l) residual[m][l] = pattern[m][l] - residual[m][l];
  }
  for (int l = 0; l < kLanes; ++l) {
    float product = 0.0F;
    for (int m = 0; m < kPattern; ++m) product += slope[m][l] * residual[m][l];
    const float correction = product / information[l];
    float square = 0.0F;
    for (int m = 0; m < kPattern; ++m) {
      const float rest = residual[m][l] - correction * slope[m][l];
      square += rest * rest;
    }
    const float total_shift = shift[l] + correction;
    // Relative to the centre of the search, along growing inverse depth.
    const float lambda = best_step[l] + total_shift - before[l];
    const float denominator = s.rate[l] * s.z[l] - lambda * s.z_rate[l];
    const float inverse_depth = s.inverse_depth[l] + lambda * s.z[l] / denominator;
    const float per_pixel = s.rate[l] * s.z[l] * s.z[l] / (denominator * denominator);
    const float variance =
        per_pixel * per_pixel * (s.geometric_variance[l] + limits.image_variance / information[l]);
    const float squared_shift = total_shift * total_shift, squared_correction = correction * correction;
    out.inverse_depth[l] = inverse_depth;
    out.variance[l] = variance;
    out.matched[l] = (square <= limits.max_square_mismatch * kPattern * limits.image_variance) &
                     (second[l] > limits.min_distinctness * best[l]) & (squared_shift <= 1.0F) &
                     (squared_correction <= 0.25F) & (best_step[l] > 0.0F) & (best_step[l] < last[l]) &
                     (inverse_depth > 0.0F) & (denominator > 0.0F);
  }
}

}  // namespace

const std::vector<StereoObservation>& EpipolarStereo::observe(
    const cv::Mat_<float>& keyframe, const StereoCandidates& candidates, const StereoView& view,
    const InverseDepthImage& estimate, const InverseDepthImage& prior, float max_inverse_depth,
    const MappingOptions& options) {
  plan(candidates, view, estimate, prior, max_inverse_depth, options);
  match(keyframe, candidates, view, options);
  return observations_;
}

void EpipolarStereo::plan(const StereoCandidates& candidates, const StereoView& view,
                          const InverseDepthImage& estimate, const InverseDepthImage& prior,
                          float max_inverse_depth, const MappingOptions& options) {
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
      bandGeometry(camera_, view, static_cast<double>(options.min_depth * max_inverse_depth));
  segments_.resize(candidates.blocks.size());
  // Blocks of like length: a block takes as long as its longest segment.
  by_length_.resize(static_cast<std::size_t>(options.max_search_length) + 4);
  for (auto& list : by_length_) list.clear();
  for (std::size_t block = 0; block < segments_.size(); ++block) {
    EpipolarSegments& s = segments_[block];
    const StereoCandidates::Block& pixels = candidates.blocks[block];
    const PairGeometry& geometry = bands[static_cast<std::size_t>(pixels.v[kLanes / 2]) / kBandRows];
    planBlock(geometry, limits, pixels, estimate.variance[0], prior.mean[0], prior.variance[0], s);
    for (int l = 0; l < kLanes; ++l) {
      if (s.after[l] < 0) continue;
      by_length_[static_cast<std::size_t>(s.before[l] + s.after[l])].push_back(
          static_cast<int>(block) * kLanes + l);
    }
  }
}

void EpipolarStereo::match(const cv::Mat_<float>& keyframe, const StereoCandidates& candidates,
                           const StereoView& view, const MappingOptions& options) {
  MatchLimits limits;
  limits.image_variance = 2.0F * options.image_noise * options.image_noise;
  limits.max_square_mismatch = options.max_mismatch * options.max_mismatch;
  limits.min_distinctness = options.min_distinctness;
  limits.gain = static_cast<float>(view.brightness.gain);
  limits.offset = static_cast<float>(view.brightness.offset);
  const SampleBlock sample = sampleBlock();
  observations_.clear();
  BlockMatches matches;
  for (const std::vector<int>& list : by_length_) {
    for (std::size_t begin = 0; begin < list.size(); begin += kLanes) {
      const std::size_t used = std::min<std::size_t>(kLanes, list.size() - begin);
      std::array<int, kLanes> chosen;
      for (std::size_t l = 0; l < kLanes; ++l) chosen[l] = list[begin + std::min(l, used - 1)];
      matchBlock(sample, keyframe[0], static_cast<int>(keyframe.step1()), (*view.image)[0],
                 static_cast<int>(view.image->step1()), candidates, segments_, chosen.data(), limits,
                 matches);
      for (std::size_t l = 0; l < used; ++l) {
        observations_.push_back(
            {candidates.pixel(chosen[l]), matches.matched[l], matches.inverse_depth[l], matches.variance[l]});
      }
    }
  }
}

}  // namespace rgbd_sfm_fusion
