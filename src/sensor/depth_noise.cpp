// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/sensor/depth_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "rgbd_sfm_fusion/multiversion.h"
#include "rgbd_sfm_fusion/option_check.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A depth of which a step leaves no more than this is as good as none; so this is where it stops counting.
constexpr float kMaxLateralRatio = 0.19f;  // of Z: with the other errors still below 0.2 Z

RGBD_SFM_FUSION_MULTIVERSION
void axialVarianceRow(const float* depth, int width, float quadratic, float floor, float* variance) {
  for (int x = 0; x < width; ++x) {
    const float sigma = quadratic * depth[x] * depth[x];
    variance[x] = sigma * sigma + floor * floor;
  }
}

RGBD_SFM_FUSION_MULTIVERSION
void limitRangeRow(const float* depth, int width, float min_range, float max_range, float* mean,
                   float* variance) {
  for (int x = 0; x < width; ++x) {
    const bool inside = (depth[x] >= min_range) & (depth[x] <= max_range);
    mean[x] = inside ? depth[x] : kNone;
    variance[x] = inside ? variance[x] : kNone;
  }
}

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
  return has_before & has_after ? 0.5f * sum : sum;
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

/// A row of an image with a NaN before and after it; all NaN outside the image.
class PaddedRow {
 public:
  explicit PaddedRow(int width) : values_(static_cast<std::size_t>(width) + 2, kNone) {}
  void load(const DepthImage& image, int y) {
    if (y < image.rows) {
      std::copy(image[y], image[y] + image.cols, values_.begin() + 1);
    } else {
      std::fill(values_.begin(), values_.end(), kNone);
    }
  }
  float* data() { return values_.data() + 1; }

 private:
  std::vector<float> values_;
};

}  // namespace

DepthNoiseModel DepthNoiseModel::astra() {
  DepthNoiseModel noise;
  noise.min_range = 0.6f;
  noise.max_range = 8.0f;
  return noise;
}

DepthNoiseModel DepthNoiseModel::preset(const std::string& name) {
  if (name == "kinect") return kinect();
  if (name == "astra") return astra();
  throw std::invalid_argument("depth noise preset = '" + name + "': must be 'kinect' or 'astra'");
}

Eigen::Vector2f DepthNoiseModel::sigmaXY(const PinholeCamera& camera, float x, float y, float depth) const {
  const Eigen::Vector3d ray = camera.backProject(static_cast<double>(x), static_cast<double>(y), 1.0);
  return ray.head<2>().cwiseAbs().cast<float>() * sigmaZ(depth);
}

float DepthNoiseModel::variance(float depth) const {
  if (!(depth >= min_range && depth <= max_range)) return kNone;
  return sigmaZ(depth) * sigmaZ(depth) + floor * floor;
}

void validate(const DepthNoiseModel& noise) {
  requireInRange("quadratic", noise.quadratic, 1e-6f, 1.0f);
  requireInRange("floor", noise.floor, 0.0f, 1.0f);
  requireInRange("lateral_sigma", noise.lateral_sigma, 0.0f, 10.0f);
  requireInRange("common_scale_sigma", noise.common_scale_sigma, 0.0f, 0.05f);
  requireInRange("min_range", noise.min_range, 1e-3f, 100.0f);
  requireInRange("max_range", noise.max_range, noise.min_range, 100.0f);
}

void addLateralVariance(float lateral_sigma, GaussianDepth* depth) {
  if (lateral_sigma <= 0.0f) return;
  const int width = depth->mean.cols, height = depth->mean.rows;
  // P(N(0, lateral_sigma²) > 1/2 px): the step is drawn to the pixel's border, half a pixel away.
  const float step_probability = 0.5f * std::erfc(0.5f / (lateral_sigma * std::sqrt(2.0f)));
  const LateralTerms terms{lateral_sigma * lateral_sigma, step_probability};
  PaddedRow rows[3] = {PaddedRow(width), PaddedRow(width), PaddedRow(width)};
  // The extremes of a column beside the image are not extreme.
  std::vector<float> low(static_cast<std::size_t>(width) + 2, kInfinity), high(low.size(), -kInfinity);
  rows[1].load(depth->mean, 0);
  for (int y = 0; y < height; ++y) {
    PaddedRow& down = rows[(y + 2) % 3];
    down.load(depth->mean, y + 1);
    const float* up = rows[y % 3].data();
    const float* middle = rows[(y + 1) % 3].data();
    extremesRow(up, middle, down.data(), width, low.data() + 1, high.data() + 1);
    lateralRow(up, middle, down.data(), low.data() + 1, high.data() + 1, width, terms, depth->variance[y]);
  }
}

GaussianDepth withNoise(const DepthImage& depth, const DepthNoiseModel& noise) {
  GaussianDepth result{depth, cv::Mat_<float>(depth.size())};
  for (int y = 0; y < depth.rows; ++y)
    axialVarianceRow(depth[y], depth.cols, noise.quadratic, noise.floor, result.variance[y]);
  addLateralVariance(noise.lateral_sigma, &result);  // with the neighbours out of range: steps to them count
  result.mean = cv::Mat_<float>(depth.size());
  for (int y = 0; y < depth.rows; ++y) {
    limitRangeRow(depth[y], depth.cols, noise.min_range, noise.max_range, result.mean[y], result.variance[y]);
  }
  return result;
}

}  // namespace rgbd_sfm_fusion
