// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/sensor/lateral_variance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A depth of which a step leaves no more than this is as good as none; so this is where it stops counting.
constexpr float kMaxLateralRatio = 0.19f;  // of Z: with the other errors still below 0.2 Z

struct LateralTerms {
  float sigma_squared;     ///< [px^2]
  float step_probability;  ///< that a step next to the pixel is on the other side of it
};

/// Half the difference of the two neighbours on the pixel's own surface, or the whole one of the only one.
inline float slope(float before, float z, float after, float step_squared) {
  const float d_before = z - before, d_after = after - z;
  const bool has_before = d_before * d_before <= step_squared;  // false for NaN
  const bool has_after = d_after * d_after <= step_squared;
  const float sum = (has_before ? d_before : 0.0f) + (has_after ? d_after : 0.0f);
  return (has_before & has_after) ? 0.5f * sum : sum;
}

/// Nearest and farthest depth among three, over which NaN is passed.
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

/// All depth pointers may be read from -1 to `width`.
RGBD_SFM_FUSION_MULTIVERSION
void lateralRow(const float* up, const float* middle, const float* down, const float* low, const float* high,
                int width, const LateralTerms terms, float* variance) {
  for (int x = 0; x < width; ++x) {
    const float z = middle[x];
    const float v = variance[x];
    const float relative_limit = kStepRatio * kStepRatio * z * z;
    const float step_squared = relative_limit > 9.0f * v ? relative_limit : 9.0f * v;

    const float gx = slope(middle[x - 1], z, middle[x + 1], step_squared);
    const float gy = slope(up[x], z, down[x], step_squared);
    const float steepness = gx * gx + gy * gy - 2.0f * v;

    const float low_lr = low[x - 1] < low[x + 1] ? low[x - 1] : low[x + 1];
    const float high_lr = high[x - 1] > high[x + 1] ? high[x - 1] : high[x + 1];
    const float to_near = z - (low_lr < low[x] ? low_lr : low[x]);
    const float to_far = (high_lr > high[x] ? high_lr : high[x]) - z;
    const float jump = to_near > to_far ? to_near : to_far;
    const float jump_squared = jump * jump;

    const float raised = v + terms.sigma_squared * (steepness > 0.0f ? steepness : 0.0f) +
                         (jump_squared > step_squared ? terms.step_probability * jump_squared : 0.0f);
    const float limit = kMaxLateralRatio * kMaxLateralRatio * z * z;
    const float capped = raised < limit ? raised : limit;
    variance[x] = v > capped ? v : capped;
  }
}

}  // namespace

LateralVariance::LateralVariance(float sigma, int width)
    : sigma_(sigma),
      // P(N(0, sigma²) > 1/2 px): the step is drawn to the pixel's border, half a pixel away.
      step_probability_(sigma > 0.0f ? 0.5f * std::erfc(0.5f / (sigma * std::sqrt(2.0f))) : 0.0f),
      // What is beside the image is no step.
      low_(static_cast<std::size_t>(width) + 2, kInfinity),
      high_(low_.size(), -kInfinity) {
  rows_.fill(PaddedRow(low_.size(), kNone));
}

void LateralVariance::addToRow(const DepthImage& depth, int y, float* variance) {
  if (sigma_ <= 0.0f) return;
  const auto row = [&](int n) -> PaddedRow& { return rows_[static_cast<std::size_t>(n + 3) % 3]; };
  if (y == 0) {
    load(depth, -1, &row(-1));
    load(depth, 0, &row(0));
  }
  load(depth, y + 1, &row(y + 1));
  const float *up = row(y - 1).data() + 1, *middle = row(y).data() + 1, *down = row(y + 1).data() + 1;
  float *low = low_.data() + 1, *high = high_.data() + 1;
  extremesRow(up, middle, down, depth.cols, low, high);
  lateralRow(up, middle, down, low, high, depth.cols, {sigma_ * sigma_, step_probability_}, variance);
}

void LateralVariance::load(const DepthImage& depth, int y, PaddedRow* row) {
  if (y >= 0 && y < depth.rows) {
    std::copy(depth[y], depth[y] + depth.cols, row->begin() + 1);
  } else {
    std::fill(row->begin(), row->end(), kNone);
  }
}

}  // namespace rgbd_sfm_fusion
