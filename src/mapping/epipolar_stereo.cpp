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

struct PlanLimits {
  float max_inverse_depth, max_u, max_v, max_length, min_gradient_squared, image_variance, epipolar_variance,
      observe_below_squared;
};

/// Bilinear value of an image of row length `stride` at positions inside it, for a block.
inline void sample(const float* image, int stride, const float (&u)[kLanes], const float (&v)[kLanes],
                   float (&value)[kLanes]) {
  float fraction_u[kLanes], fraction_v[kLanes];
  int index[kLanes];
  for (int l = 0; l < kLanes; ++l) {
    const int column = static_cast<int>(u[l]), row = static_cast<int>(v[l]);
    fraction_u[l] = u[l] - static_cast<float>(column);
    fraction_v[l] = v[l] - static_cast<float>(row);
    index[l] = row * stride + column;
  }
  float a[kLanes], b[kLanes], c[kLanes], d[kLanes];
  for (int l = 0; l < kLanes; ++l) a[l] = image[index[l]];
  for (int l = 0; l < kLanes; ++l) b[l] = image[index[l] + 1];
  for (int l = 0; l < kLanes; ++l) c[l] = image[index[l] + stride];
  for (int l = 0; l < kLanes; ++l) d[l] = image[index[l] + stride + 1];
  for (int l = 0; l < kLanes; ++l) {
    const float top = a[l] + fraction_u[l] * (b[l] - a[l]);
    const float bottom = c[l] + fraction_u[l] * (d[l] - c[l]);
    value[l] = top + fraction_v[l] * (bottom - top);
  }
}

}  // namespace

void StereoCandidates::collect(const cv::Mat_<float>& image_gradient_x,
                               const cv::Mat_<float>& image_gradient_y, float min_gradient) {
  const int width = image_gradient_x.cols, height = image_gradient_x.rows;
  const auto capacity = static_cast<std::size_t>(width * height);
  u.resize(capacity), v.resize(capacity), gradient_x.resize(capacity), gradient_y.resize(capacity);
  pixel.resize(capacity);
  std::size_t n = 0;
  for (int row = kBorder; row < height - kBorder; ++row) {
    const float *gx = image_gradient_x[row], *gy = image_gradient_y[row];
    for (int column = kBorder; column < width - kBorder; ++column) {
      u[n] = static_cast<float>(column);
      v[n] = static_cast<float>(row);
      gradient_x[n] = gx[column];
      gradient_y[n] = gy[column];
      pixel[n] = row * width + column;
      n += gx[column] * gx[column] + gy[column] * gy[column] >= min_gradient * min_gradient ? 1U : 0U;
    }
  }
  u.resize(n), v.resize(n), gradient_x.resize(n), gradient_y.resize(n), pixel.resize(n);
}

void EpipolarSegments::resize(std::size_t size) {
  for (auto* array : {&u, &v, &du, &dv, &eu, &ev, &inverse_depth, &rate, &z, &z_rate, &geometric_variance}) {
    array->resize(size);
  }
  before.resize(size);
  after.resize(size);
}

namespace {

/// Epipolar segments of the first `count` candidates.
RGBD_SFM_FUSION_MULTIVERSION
void planSegments(const PairGeometry& g, const PlanLimits& limits, const StereoCandidates& candidates,
                  const float* estimate_variances, const float* prior_means, const float* prior_variances,
                  int count, EpipolarSegments& s) {
  const int* pixels = candidates.pixel.data();
  const float *us = candidates.u.data(), *vs = candidates.v.data();
  const float *gradients_x = candidates.gradient_x.data(), *gradients_y = candidates.gradient_y.data();
  float *out_u = s.u.data(), *out_v = s.v.data(), *out_du = s.du.data(), *out_dv = s.dv.data();
  float *out_eu = s.eu.data(), *out_ev = s.ev.data(), *out_inverse_depth = s.inverse_depth.data();
  float *out_rate = s.rate.data(), *out_z = s.z.data(), *out_z_rate = s.z_rate.data();
  float* out_geometric = s.geometric_variance.data();
  int *out_before = s.before.data(), *out_after = s.after.data();
  for (int i = 0; i < count; ++i) {
    const float prior_mean = prior_means[pixels[i]], prior_variance = prior_variances[pixels[i]];
    const float estimate_variance = estimate_variances[pixels[i]];
    const float u = us[i], v = vs[i], gradient_x = gradients_x[i], gradient_y = gradients_y[i];

    const bool has_prior = prior_mean > 0.0F;
    const float reach = 2.0F * std::sqrt(has_prior ? prior_variance : 0.0F);
    const float near =
        has_prior ? std::min(prior_mean + reach, limits.max_inverse_depth) : limits.max_inverse_depth;
    const float far = has_prior ? std::max(prior_mean - reach, 0.0F) : 0.0F;
    const float centre = 0.5F * (near + far);

    // H (u, v, 1) + ρ b, at the centre and at both ends.
    const float hx = g.H[0] * u + g.H[1] * v + g.H[2];
    const float hy = g.H[3] * u + g.H[4] * v + g.H[5];
    const float hz = g.H[6] * u + g.H[7] * v + g.H[8];
    const float z = hz + centre * g.b[2], z_near = hz + near * g.b[2], z_far = hz + far * g.b[2];
    const float inverse_z = 1.0F / z, inverse_z_near = 1.0F / z_near, inverse_z_far = 1.0F / z_far;
    const float cu = (hx + centre * g.b[0]) * inverse_z, cv = (hy + centre * g.b[1]) * inverse_z;
    const float rate_u = (g.b[0] - cu * g.b[2]) * inverse_z, rate_v = (g.b[1] - cv * g.b[2]) * inverse_z;
    const float rate = std::sqrt(rate_u * rate_u + rate_v * rate_v);
    const float du = rate_u / rate, dv = rate_v / rate;
    const float to_near =
        ((hx + near * g.b[0]) * inverse_z_near - cu) * du + ((hy + near * g.b[1]) * inverse_z_near - cv) * dv;
    const float to_far =
        (cu - (hx + far * g.b[0]) * inverse_z_far) * du + (cv - (hy + far * g.b[1]) * inverse_z_far) * dv;

    // The keyframe's epipolar line: the step that moves the projection by one pixel at this depth.
    const float m00 = (g.H[0] - cu * g.H[6]) * inverse_z, m01 = (g.H[1] - cu * g.H[7]) * inverse_z;
    const float m10 = (g.H[3] - cv * g.H[6]) * inverse_z, m11 = (g.H[4] - cv * g.H[7]) * inverse_z;
    const float determinant = m00 * m11 - m01 * m10;
    const float eu = (m11 * du - m01 * dv) / determinant, ev = (m00 * dv - m10 * du) / determinant;
    const float stretch_squared = eu * eu + ev * ev;
    const float gradient_squared = gradient_x * gradient_x + gradient_y * gradient_y;
    const float along = gradient_x * eu + gradient_y * ev;
    const float cosine_squared = along * along / (gradient_squared * stretch_squared);
    const float geometric = limits.epipolar_variance / cosine_squared + kSubpixelVariance;
    const float photometric = limits.image_variance / (2.0F * along * along);
    const float predicted_variance = (geometric + photometric) / (rate * rate);

    const float before = std::min(to_far, 1000.0F), after = std::min(to_near, 1000.0F);
    const int steps_before = static_cast<int>(before + 1.5F), steps_after = static_cast<int>(after + 1.5F);
    const float low = static_cast<float>(-steps_before - kPatternRadius - 2);
    const float high = static_cast<float>(steps_after + kPatternRadius + 2);
    const float u0 = cu + low * du, u1 = cu + high * du, v0 = cv + low * dv, v1 = cv + high * dv;
    const bool useful = predicted_variance < limits.observe_below_squared * estimate_variance;
    const bool possible =
        (z_near > 0.2F) & (z_far > 0.2F) & (rate > 1e-3F) & (to_far >= 0.0F) & (to_near >= 0.0F) &
        (before + after <= limits.max_length) & (cosine_squared >= kMinCosine * kMinCosine) &
        (along * along >= limits.min_gradient_squared) & (stretch_squared >= kMinStretch * kMinStretch) &
        (stretch_squared <= kMaxStretch * kMaxStretch) & (std::min(u0, u1) >= 0.0F) &
        (std::min(v0, v1) >= 0.0F) & (std::max(u0, u1) < limits.max_u) & (std::max(v0, v1) < limits.max_v);
    out_u[i] = cu, out_v[i] = cv, out_du[i] = du, out_dv[i] = dv, out_eu[i] = eu, out_ev[i] = ev;
    out_inverse_depth[i] = centre, out_rate[i] = rate, out_z[i] = z, out_z_rate[i] = g.b[2];
    out_geometric[i] = geometric;
    out_before[i] = steps_before;
    out_after[i] = useful & possible ? steps_after : -1;
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
void matchBlock(const float* keyframe, int keyframe_stride, const float* view, int view_stride,
                const StereoCandidates& candidates, const EpipolarSegments& s, const int* chosen,
                const MatchLimits& limits, BlockMatches& out) {
  float u[kLanes], v[kLanes], du[kLanes], dv[kLanes], before[kLanes], last[kLanes];
  float pattern[kPattern][kLanes];
  int steps = 0;
  for (int l = 0; l < kLanes; ++l) {
    const auto i = static_cast<std::size_t>(chosen[l]);
    du[l] = s.du[i], dv[l] = s.dv[i];
    before[l] = static_cast<float>(s.before[i]);
    last[l] = static_cast<float>(s.before[i] + s.after[i]);
    u[l] = s.u[i] - before[l] * du[l], v[l] = s.v[i] - before[l] * dv[l];
    steps = std::max(steps, s.before[i] + s.after[i] + 1);
  }
  for (int m = 0; m < kPattern; ++m) {
    float pu[kLanes], pv[kLanes];
    for (int l = 0; l < kLanes; ++l) {
      const auto i = static_cast<std::size_t>(chosen[l]);
      pu[l] = candidates.u[i] + static_cast<float>(m - kPatternRadius) * s.eu[i];
      pv[l] = candidates.v[i] + static_cast<float>(m - kPatternRadius) * s.ev[i];
    }
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
      const float position = std::min(static_cast<float>(k), last[l] + 2.0F * kLead) - kLead;
      su[l] = u[l] + position * du[l];
      sv[l] = v[l] + position * dv[l];
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
      best[l] = std::min(sum, best[l]);
    }
  }
  float second[kLanes];
  for (int l = 0; l < kLanes; ++l) second[l] = 1e30F;
  for (int j = 0; j < steps; ++j) {
    const auto step = static_cast<float>(j);
    for (int l = 0; l < kLanes; ++l) {
      const bool apart = std::abs(step - best_step[l]) > 1.5F;
      second[l] = apart ? std::min(second[l], error[j][l]) : second[l];
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
    information[l] = std::max(square, 1e-3F);
    shift[l] = std::min(std::max(product / information[l], -1.0F), 1.0F);
  }
  float residual[kPattern][kLanes];
  for (int m = 0; m < kPattern; ++m) {
    for (int l = 0; l < kLanes; ++l) {
      const float position = best_step[l] + shift[l] + static_cast<float>(m - kPatternRadius);
      su[l] = u[l] + position * du[l];
      sv[l] = v[l] + position * dv[l];
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
    const auto i = static_cast<std::size_t>(chosen[l]);
    const float denominator = s.rate[i] * s.z[i] - lambda * s.z_rate[i];
    const float inverse_depth = s.inverse_depth[i] + lambda * s.z[i] / denominator;
    const float per_pixel = s.rate[i] * s.z[i] * s.z[i] / (denominator * denominator);
    const float variance =
        per_pixel * per_pixel * (s.geometric_variance[i] + limits.image_variance / information[l]);
    out.inverse_depth[l] = inverse_depth;
    out.variance[l] = variance;
    out.matched[l] = (square <= limits.max_square_mismatch * kPattern * limits.image_variance) &
                     (second[l] > limits.min_distinctness * best[l]) & (std::abs(total_shift) <= 1.0F) &
                     (std::abs(correction) <= 0.5F) & (best_step[l] > 0.0F) & (best_step[l] < last[l]) &
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
  limits.max_u = static_cast<float>(camera_.width - 1), limits.max_v = static_cast<float>(camera_.height - 1);
  limits.max_length = static_cast<float>(options.max_search_length);
  limits.min_gradient_squared = 0.25F * options.min_gradient * options.min_gradient;
  limits.image_variance = 2.0F * options.image_noise * options.image_noise;
  limits.epipolar_variance = options.epipolar_noise * options.epipolar_noise;
  limits.observe_below_squared = options.observe_below * options.observe_below;
  const int count = candidates.count();
  segments_.resize(static_cast<std::size_t>(count));
  planSegments(pairGeometry(camera_, view.T_view_keyframe), limits, candidates, estimate.variance[0],
               prior.mean[0], prior.variance[0], count, segments_);

  // Blocks of like length: a block takes as long as its longest segment.
  by_length_.resize(static_cast<std::size_t>(options.max_search_length) + 4);
  for (auto& list : by_length_) list.clear();
  for (int i = 0; i < count; ++i) {
    const auto index = static_cast<std::size_t>(i);
    if (segments_.after[index] < 0) continue;
    by_length_[static_cast<std::size_t>(segments_.before[index] + segments_.after[index])].push_back(i);
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
  observations_.clear();
  BlockMatches matches;
  for (const std::vector<int>& list : by_length_) {
    for (std::size_t begin = 0; begin < list.size(); begin += kLanes) {
      const std::size_t used = std::min<std::size_t>(kLanes, list.size() - begin);
      std::array<int, kLanes> chosen;
      for (std::size_t l = 0; l < kLanes; ++l) chosen[l] = list[begin + std::min(l, used - 1)];
      matchBlock(keyframe[0], static_cast<int>(keyframe.step1()), (*view.image)[0],
                 static_cast<int>(view.image->step1()), candidates, segments_, chosen.data(), limits,
                 matches);
      for (std::size_t l = 0; l < used; ++l) {
        observations_.push_back({candidates.pixel[static_cast<std::size_t>(chosen[l])], matches.matched[l],
                                 matches.inverse_depth[l], matches.variance[l]});
      }
    }
  }
}

}  // namespace rgbd_sfm_fusion
