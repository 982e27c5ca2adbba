// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/gaussian_fusion.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "rgbd_sfm_fusion/fusion/evidence.h"
#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kSensor = static_cast<int>(Provenance::kSensor);
constexpr int kSfm = static_cast<int>(Provenance::kSfm);
constexpr int kFused = static_cast<int>(Provenance::kFused);
constexpr int kSensorWins = static_cast<int>(Disagreement::kSensorKept);
constexpr int kTooNear = static_cast<int>(Disagreement::kSfmKept);
static_assert(kFused == (kSensor | kSfm), "fused is both");

constexpr float kNoLimit = std::numeric_limits<float>::max();

/// Largest common error, relative to SfM's inverse depth. Depths that agree differ by less.
constexpr float kLargestError = 0.1f;

/// A wrong SfM depth is of some other surface, anywhere within this share of the depth.
constexpr float kOtherSurfaces = 1.0f;

/// The inputs of one row; NaN = no depth.
struct Inputs {
  const float *sensor_mean, *sensor_variance, *surface_variance, *of_any_range, *sfm_mean, *sfm_variance;
};

/// Inputs row by row. An empty image has no depth.
class Rows {
 public:
  Rows(const SensorDepth& sensor, const GaussianDepth& sfm)
      : sensor_(sensor), sfm_(sfm), none_(static_cast<std::size_t>(sensor.depth.mean.cols), kNoDepth) {}

  cv::Size size() const { return sensor_.depth.mean.size(); }

  Inputs operator[](int y) const {
    const auto row = [&](const cv::Mat_<float>& image) { return image.empty() ? none_.data() : image[y]; };
    return {sensor_.depth.mean[y],
            sensor_.depth.variance[y],
            sensor_.surfaceVariance()[y],
            row(sensor_.of_any_range),
            row(sfm_.mean),
            row(sfm_.variance)};
  }

 private:
  const SensorDepth& sensor_;
  const GaussianDepth& sfm_;
  std::vector<float> none_;
};

/// Natural logarithm, to 0.06: exact at powers of two, linear between them.
inline float roughLogarithm(float value) {
  std::int32_t bits;
  std::memcpy(&bits, &value, sizeof(bits));
  return static_cast<float>(bits - 0x3f800000) * (0.69314718f / 0x800000);
}

/// -2 ln of a likelihood ratio, but for a constant: how likely the difference is between depths of one
/// surface, over how likely it is between depths of two. Small where depths agree and are certain.
inline float unlikeliness(float square, float variance, float d) {
  return square / variance + roughLogarithm(variance / (d * d));
}

/// `averaged`: depths up to this unlikeliness are averaged. `contradicts`: depths above it contradict each
/// other.
struct Limits {
  float averaged, contradicts;
};

/// Decides the source of each depth. Where the two depths exceed `averaged`, the sensor's is taken.
RGBD_SFM_FUSION_MULTIVERSION
void classifyRow(const Inputs in, int width, const float* odds, const Limits limits, float min_range,
                 std::uint8_t* __restrict provenance, std::uint8_t* __restrict disagreement) {
  for (int x = 0; x < width; ++x) {
    const float d = in.sensor_mean[x], m = in.sfm_mean[x], vm = in.sfm_variance[x], any = in.of_any_range[x];
    const bool too_near = any < min_range;
    const float measured = too_near ? any : d, vd = too_near ? 0.0f : in.sensor_variance[x];
    const float difference = m - d, off = m - measured, known = 2.0f * odds[x];
    const bool averaged =
        unlikeliness(difference * difference, in.surface_variance[x] + vm, d) <= limits.averaged + known;
    const bool contradicts = unlikeliness(off * off, vd + vm, measured) > limits.contradicts + known;
    const int sensor = d > 0.0f ? kSensor : 0;
    const int sfm = averaged | ((m > 0.0f) & !(d > 0.0f)) ? kSfm : 0;
    provenance[x] = static_cast<std::uint8_t>(sensor | sfm);
    disagreement[x] = static_cast<std::uint8_t>(contradicts ? (too_near ? kTooNear : kSensorWins) : 0);
  }
}

/// Averages wherever a pixel has both depths, as in the paper.
RGBD_SFM_FUSION_MULTIVERSION
void takeAllRow(const Inputs in, int width, std::uint8_t* __restrict provenance,
                std::uint8_t* __restrict disagreement) {
  for (int x = 0; x < width; ++x) {
    const int sensor = in.sensor_mean[x] > 0.0f ? kSensor : 0, sfm = in.sfm_mean[x] > 0.0f ? kSfm : 0;
    provenance[x] = static_cast<std::uint8_t>(sensor | sfm);
    disagreement[x] = 0;
  }
}

struct RowCounts {
  int with_sensor = 0, with_sfm = 0, fused = 0, disagreeing = 0;
};

RGBD_SFM_FUSION_MULTIVERSION
void countRow(const std::uint8_t* provenance, const std::uint8_t* disagreement, int width,
              RowCounts* __restrict counts) {
  int with_sensor = 0, with_sfm = 0, fused = 0, disagreeing = 0;
  for (int x = 0; x < width; ++x) {
    const int source = provenance[x];
    with_sensor += source & 1;
    with_sfm += source >> 1;
    fused += source & (source >> 1);
    disagreeing += disagreement[x] != 0 ? 1 : 0;
  }
  *counts = {with_sensor, with_sfm, fused, disagreeing};
}

void countRow(int y, GaussianFusion* result) {
  RowCounts row;
  countRow(result->provenance[y], result->disagreement[y], result->provenance.cols, &row);
  result->counts += ProvenanceCounts{static_cast<std::uint64_t>(row.with_sensor - row.fused),
                                     static_cast<std::uint64_t>(row.with_sfm - row.fused),
                                     static_cast<std::uint64_t>(row.fused)};
  result->disagreeing += static_cast<std::uint64_t>(row.disagreeing);
}

/// @param min_probability  of depths that are averaged
Limits limitsOf(double min_probability) {
  const double p = std::max(min_probability, 0.5);  // below 1/2, two surfaces are more probable
  const double even = 2.0 * std::log(static_cast<double>(kOtherSurfaces) / std::sqrt(2.0 * M_PI));
  return {static_cast<float>(even - 2.0 * std::log(p / (1.0 - p))), static_cast<float>(even)};
}

/// Gives each pixel of a row the value of its cell.
RGBD_SFM_FUSION_MULTIVERSION
void spreadRow(const float* cells, int count, float* __restrict pixels) {
  for (int cell = 0; cell < count; ++cell) {
    for (int i = 0; i < Evidence::kCell; ++i) pixels[Evidence::kCell * cell + i] = cells[cell];
  }
}

/// Evidence around each pixel of a row; see Evidence.
struct RowEvidence {
  std::vector<float> odds, difference, noise_variance;

  /// Starts without evidence.
  explicit RowEvidence(int width)
      : odds(static_cast<std::size_t>(width + Evidence::kCell), 0.0f),
        difference(odds.size(), 0.0f),
        noise_variance(odds.size(), std::numeric_limits<float>::infinity()) {}

  void set(const Evidence& evidence, bool align_locally, int y) {
    const int row = y / Evidence::kCell, count = evidence.odds.cols;
    spreadRow(evidence.odds[row], count, odds.data());
    if (!align_locally) return;
    spreadRow(evidence.difference[row], count, difference.data());
    spreadRow(evidence.noise_variance[row], count, noise_variance.data());
  }
};

/// Eq. 11 and 12, with SfM's depth corrected by the error that it shares with its surroundings. Where a pixel
/// is not averaged, the depth that was chosen.
RGBD_SFM_FUSION_MULTIVERSION
void fuseRow(const Inputs in, const RowEvidence& errors, const std::uint8_t* provenance, int width,
             const DepthNoiseModel noise, const SensorOffsetGain offset, float* __restrict mean,
             float* __restrict variance) {
  const float scale_variance = noise.common_scale_sigma * noise.common_scale_sigma;
  const float offset_variance = noise.common_offset_sigma * noise.common_offset_sigma;
  const float *difference = errors.difference.data(), *noise_variance = errors.noise_variance.data();
  for (int x = 0; x < width; ++x) {
    const float d = in.sensor_mean[x], vd = in.sensor_variance[x], vs = in.surface_variance[x];
    const float m = in.sfm_mean[x], vm = in.sfm_variance[x];
    const float common = Evidence::kShare * vm, squared = m * m;
    const float known = common / (common + noise_variance[x] * squared * squared);
    const float found = known * difference[x] * m;  // share of the inverse depth
    const float error = lesser(greater(found, -kLargestError), kLargestError);
    const float stretch = 1.0f + error + error * error;  // 1 / (1 - error)
    const float stretch_squared = stretch * stretch;
    const float aligned = m * stretch;
    const float aligned_variance = (vm - known * common) * stretch_squared * stretch_squared;
    const float gain = vs / (vs + aligned_variance);
    const float product = gain * aligned_variance;
    const float least = vs < vm ? vs : vm;  // rounding or stretching could make the product larger
    const bool averaged = provenance[x] == kFused, has_sensor = d > 0.0f;
    const float z = averaged ? d + gain * (aligned - d) : (has_sensor ? d : m);
    // The weights contain the bias of the sensor's far depth. The variance gets the whole bias, since
    // averaging does not reduce it.
    const float sensor_share = 1.0f - gain;
    const float bias = noise.farVariance(d) * (1.0f - sensor_share * sensor_share);
    const float v = averaged ? (product < least ? product : least) + bias : (has_sensor ? vd : vm);
    mean[x] = z;
    const float of_sfm = (offset.base + offset.x_gain * static_cast<float>(x)) * z + offset.relative;
    const float by_offset = has_sensor ? z : of_sfm;
    variance[x] = v + (scale_variance + offset_variance * by_offset * by_offset) * z * z;
  }
}

}  // namespace

GaussianFusion fuse(const SensorDepth& sensor, const GaussianDepth& sfm, const GaussianFusionOptions& options,
                    GaussianFusion buffer, const SensorOffsetGain& gain) {
  const cv::Size size = sensor.depth.mean.size();
  GaussianFusion result = std::move(buffer);
  result.counts = {};
  result.disagreeing = 0;
  result.depth.mean.create(size);
  result.depth.variance.create(size);
  result.provenance.create(size);
  result.disagreement.create(size);
  const bool weighs = options.test_agreement && !sfm.mean.empty();
  Evidence evidence;
  if (weighs) evidence = evidenceAround(sensor, sfm, static_cast<float>(options.max_chi_squared));
  const Limits limits = limitsOf(options.min_inlier_probability);
  const Rows rows(sensor, sfm);
  RowEvidence around(size.width);
  for (int y = 0; y < size.height; ++y) {
    std::uint8_t *provenance = result.provenance[y], *disagreement = result.disagreement[y];
    const Inputs in = rows[y];
    if (weighs) {
      if (y % Evidence::kCell == 0) around.set(evidence, options.align_locally, y);
      classifyRow(in, size.width, around.odds.data(), limits, sensor.noise.min_range, provenance,
                  disagreement);
    } else {
      takeAllRow(in, size.width, provenance, disagreement);
    }
    countRow(y, &result);
    SensorOffsetGain of_row = gain;
    of_row.base += gain.y_gain * static_cast<float>(y);
    fuseRow(in, around, provenance, size.width, sensor.noise, of_row, result.depth.mean[y],
            result.depth.variance[y]);
  }
  return result;
}

}  // namespace rgbd_sfm_fusion
