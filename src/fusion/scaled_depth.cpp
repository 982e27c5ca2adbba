// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/scaled_depth.h"

#include <limits>
#include <utility>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// Errors of SfM depth, as variances.
struct ScaledErrors {
  float alpha;
  float factor;                   // of the stated variance
  float relative;                 // [1]
  float shared;                   // [1/m²] of inverse depth
  float stretch, stretch_middle;  // [1], [1/m]
  float max_relative;             // [1] of what is used
};

RGBD_SFM_FUSION_MULTIVERSION
void scaleRow(const ScaledErrors& errors, int width, float* __restrict mean, float* __restrict variance) {
  for (int x = 0; x < width; ++x) {
    const float z = errors.alpha * mean[x], squared = z * z;
    const float stretched = 1.0f - errors.stretch_middle * z;
    const float v = errors.factor * variance[x] + squared * (errors.relative + errors.shared * squared +
                                                             errors.stretch * stretched * stretched);
    const bool usable = (z > 0.0f) & (v > 0.0f) & (v <= errors.max_relative * squared);
    mean[x] = usable ? z : kNone;
    variance[x] = usable ? v : kNone;
  }
}

}  // namespace

GaussianDepth scaled(const GaussianDepth& sfm, const ScaleTerms& scale, double max_relative_sigma,
                     GaussianDepth buffer) {
  GaussianDepth result = std::move(buffer);
  sfm.mean.copyTo(result.mean);  // does nothing where they are the same
  sfm.variance.copyTo(result.variance);
  const auto square = [](double value) { return static_cast<float>(value * value); };
  const ScaledErrors errors{static_cast<float>(scale.alpha),
                            static_cast<float>(scale.variance_factor) * square(scale.alpha),
                            square(scale.sigma_alpha / scale.alpha),
                            square(scale.shared_sigma),
                            square(scale.stretch_sigma),
                            static_cast<float>(scale.stretch_middle),
                            square(max_relative_sigma)};
  for (int y = 0; y < result.mean.rows; ++y)
    scaleRow(errors, result.mean.cols, result.mean[y], result.variance[y]);
  return result;
}

}  // namespace rgbd_sfm_fusion
