// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/sensor/lateral_variance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct LateralTerms {
  float sigma_squared;     ///< [px^2]
  float step_probability;  ///< probability that a step next to the pixel is on its other side
};

/// Half the difference of the two neighbours, if both are on the pixel's own surface. If only one neighbour
/// is on this surface: the difference between this neighbour and the pixel.
inline float slope(float before, float z, float after, float step_squared) {
  const float d_before = z - before, d_after = after - z;
  const bool has_before = d_before * d_before <= step_squared;  // false for NaN
  const bool has_after = d_after * d_after <= step_squared;
  // A factor is used because compilers would turn a choice into three cases.
  const float factor = 1.0f - 0.5f * static_cast<float>(has_before & has_after);
  return factor * ((has_before ? d_before : 0.0f) + (has_after ? d_after : 0.0f));
}

/// Nearest and farthest depth among three. NaN is passed over.
RGBD_SFM_FUSION_MULTIVERSION
void extremesRow(const float* up, const float* middle, const float* down, int width, float* low,
                 float* high) {
  for (int x = 0; x < width; ++x) {
    const float a = up[x], b = middle[x], c = down[x];
    float near = kInfinity, far = -kInfinity;
    near = a < near ? a : near;
    far = a > far ? a : far;
    near = b < near ? b : near;
    far = b > far ? b : far;
    near = c < near ? c : near;
    far = c > far ? c : far;
    low[x] = near;
    high[x] = far;
  }
}

/// The surroundings of a pixel: depths beside, above and below the pixel, and extremes of the three columns.
struct Surroundings {
  float left, right, up, down, low, high;
};

struct Raised {
  float variance, surface_variance;
};

inline Raised raised(float z, float v, const Surroundings& around, const LateralTerms& terms) {
  const float relative_limit = kStepRatio * kStepRatio * z * z;
  const float step_squared = relative_limit > 9.0f * v ? relative_limit : 9.0f * v;

  const float gx = slope(around.left, z, around.right, step_squared);
  const float gy = slope(around.up, z, around.down, step_squared);
  const float steepness = gx * gx + gy * gy - 2.0f * v;

  const float to_near = z - around.low, to_far = around.high - z;
  const float jump = to_near > to_far ? to_near : to_far;
  const float jump_squared = jump * jump;

  const float on_slope = v + terms.sigma_squared * (steepness > 0.0f ? steepness : 0.0f);
  const float at_step =
      on_slope + (jump_squared > step_squared ? terms.step_probability * jump_squared : 0.0f);
  const float limit = kMaxRelativeSigma * kMaxRelativeSigma * z * z;
  const float highest = v > limit ? v : limit;
  return {at_step < highest ? at_step : highest, on_slope < highest ? on_slope : highest};
}

struct LateralRow {
  const float *up, *middle, *down;
  const float *low, *high;  ///< may be read from -1 to `width`
  int width;

  Raised at(int x, float left, float right, float v, const LateralTerms& terms) const {
    const float low_lr = low[x - 1] < low[x + 1] ? low[x - 1] : low[x + 1];
    const float high_lr = high[x - 1] > high[x + 1] ? high[x - 1] : high[x + 1];
    const Surroundings around{left,
                              right,
                              up[x],
                              down[x],
                              low_lr < low[x] ? low_lr : low[x],
                              high_lr > high[x] ? high_lr : high[x]};
    return raised(middle[x], v, around, terms);
  }
};

RGBD_SFM_FUSION_MULTIVERSION
void lateralRow(const LateralRow row, int begin, int end, const LateralTerms terms,
                float* __restrict variance, float* __restrict surface_variance) {
  const auto set = [&](int x, float left, float right) {
    const Raised result = row.at(x, left, right, variance[x], terms);
    variance[x] = result.variance;
    surface_variance[x] = result.surface_variance;
  };
  const int last = row.width - 1;
  if (begin == 0) set(0, kNoDepth, row.middle[1]);
  for (int x = begin > 0 ? begin : 1, inner_end = end < last ? end : last; x < inner_end; ++x) {
    const Raised result = row.at(x, row.middle[x - 1], row.middle[x + 1], variance[x], terms);
    variance[x] = result.variance;
    surface_variance[x] = result.surface_variance;
  }
  if (end > last) set(last, row.middle[last - 1], kNoDepth);
}

}  // namespace

LateralVariance::LateralVariance(float sigma, int width)
    : sigma_(sigma),
      // P(N(0, sigma²) > 1/2 px): the step is drawn to the pixel's border, half a pixel away.
      step_probability_(sigma > 0.0f ? 0.5f * std::erfc(0.5f / (sigma * std::sqrt(2.0f))) : 0.0f),
      none_(static_cast<std::size_t>(width), kNoDepth),
      // The border of the image is no step.
      low_(none_.size() + 2, kInfinity),
      high_(none_.size() + 2, -kInfinity),
      scratch_(none_.size()) {}

void LateralVariance::addToRow(const DepthImage& depth, int y, const cv::Range& columns, float* variance,
                               float* surface_variance) {
  if (surface_variance == nullptr) surface_variance = scratch_.data();
  if (sigma_ <= 0.0f || depth.cols < 2) {
    std::copy(variance + columns.start, variance + columns.end, surface_variance + columns.start);
    return;
  }
  const LateralRow row{y > 0 ? depth[y - 1] : none_.data(),
                       depth[y],
                       y + 1 < depth.rows ? depth[y + 1] : none_.data(),
                       low_.data() + 1,
                       high_.data() + 1,
                       depth.cols};
  const int first = std::max(columns.start - 1, 0), end = std::min(columns.end + 1, depth.cols);
  extremesRow(row.up + first, row.middle + first, row.down + first, end - first, low_.data() + 1 + first,
              high_.data() + 1 + first);
  lateralRow(row, columns.start, columns.end, {sigma_ * sigma_, step_probability_}, variance,
             surface_variance);
}

}  // namespace rgbd_sfm_fusion
