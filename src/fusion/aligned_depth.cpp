// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/aligned_depth.h"

#include <utility>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

/// A state on one row of the image. `_x` and `_xx` are coefficients of x and x², with x the sideways slope of
/// the ray.
struct RowState {
  float alpha;
  float shift, shift_x;                     // [1/m] b + c · (x, y)
  float relative;                           // [1] variance of ln α
  float mixed, mixed_x;                     // [1/m] -2 Cov(ln α, shift)
  float absolute, absolute_x, absolute_xx;  // [1/m²] variance of the shift
  float factor;                             // [m²/unit²] of the stated variance
  float max_relative;                       // [1] largest variance over Z² of depth that is used
};

RowState rowState(const SfmState& state, const SfmErrors& errors, double max_relative_sigma, double y) {
  const Eigen::Matrix4d& P = state.covariance;
  const auto number = [](double value) { return static_cast<float>(value); };
  return {number(state.alpha),
          number(state.offset + state.tilt.y() * y),
          number(state.tilt.x()),
          number(P(0, 0)),
          number(-2.0 * (P(0, 1) + P(0, 3) * y)),
          number(-2.0 * P(0, 2)),
          number(P(1, 1) + 2.0 * P(1, 3) * y + P(3, 3) * y * y),
          number(2.0 * (P(1, 2) + P(2, 3) * y)),
          number(P(2, 2)),
          number(errors.variance_factor) * number(state.alpha * state.alpha),
          number(max_relative_sigma * max_relative_sigma)};
}

/// Other errors of inverse depth, as variances.
struct Besides {
  float shared;           // [1/m²]
  float stretch, middle;  // [1], [1/m]
};

RGBD_SFM_FUSION_MULTIVERSION
void alignRow(const RowState s, const Besides besides, int width, float x_first, float x_step,
              float* __restrict mean, float* __restrict variance) {
  for (int i = 0; i < width; ++i) {
    const float x = x_first + x_step * static_cast<float>(i);
    const float scaled = s.alpha * mean[i];
    const float change = 1.0f + scaled * (s.shift + s.shift_x * x);
    const float gain = 1.0f / change, z = scaled * gain, gain_squared = gain * gain, squared = z * z;
    const float by_state = gain_squared * s.relative + gain * z * (s.mixed + s.mixed_x * x) +
                           squared * (s.absolute + x * (s.absolute_x + x * s.absolute_xx));
    const float stretched = 1.0f - besides.middle * z;
    const float others = besides.shared * squared + besides.stretch * stretched * stretched;
    const float v = s.factor * variance[i] * gain_squared * gain_squared +
                    squared * ((by_state > 0.0f ? by_state : 0.0f) + others);
    const bool usable = (change > 0.0f) & (z > 0.0f) & (v > 0.0f) & (v <= s.max_relative * squared);
    mean[i] = usable ? z : kNoDepth;
    variance[i] = usable ? v : kNoDepth;
  }
}

}  // namespace

GaussianDepth aligned(const GaussianDepth& sfm, const SfmState& state, const SfmErrors& errors,
                      const PinholeCamera& camera, double max_relative_sigma, GaussianDepth buffer) {
  GaussianDepth result = std::move(buffer);
  sfm.mean.copyTo(result.mean);  // does nothing if both are the same image
  sfm.variance.copyTo(result.variance);
  const auto square = [](double value) { return static_cast<float>(value * value); };
  const Besides besides{square(errors.shared_sigma), square(errors.stretch_sigma),
                        static_cast<float>(errors.stretch_middle)};
  for (int y = 0; y < result.mean.rows; ++y) {
    const RowState row = rowState(state, errors, max_relative_sigma, (y - camera.cy) / camera.fy);
    alignRow(row, besides, result.mean.cols, static_cast<float>(-camera.cx / camera.fx),
             static_cast<float>(1.0 / camera.fx), result.mean[y], result.variance[y]);
  }
  return result;
}

}  // namespace rgbd_sfm_fusion
