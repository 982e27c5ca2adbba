// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/gaussian_fusion.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "area_votes.h"
#include "rgbd_sfm_fusion/fusion/common_errors.h"
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

/// Of a pixel that is against its area's being averaged: two sigma. Errors of an area are alike, so that many
/// such pixels say more than one.
constexpr float kAreaChiSquared = 4.0f;

/// σ of SfM depth beyond which it is not averaged, as a share of the sensor's depth. Within its range the
/// sensor's own is a sixth of that at most: nothing would be gained, and SfM would agree with what is a tenth
/// nearer or farther, too.
constexpr float kLargestRelativeSigma = 0.045f;

/// Of SfM's inverse depth, in common with its surroundings. Depths that agree differ by less.
constexpr float kLargestError = 0.1f;

/// A smaller overlap says nothing about the frame as a whole.
constexpr std::uint64_t kLeastOverlap = 200;  // [px]

/// What there is of each pixel of a row; 0 or NaN = none.
struct Inputs {
  const float *sensor_mean, *sensor_variance, *surface_variance, *raw, *sfm_mean, *sfm_variance;
};

/// Inputs row by row. Images that are empty have nothing.
class Rows {
 public:
  Rows(const SensorDepth& sensor, const GaussianDepth& sfm)
      : sensor_(sensor), sfm_(sfm), none_(static_cast<std::size_t>(sensor.depth.mean.cols), kNoDepth) {}

  cv::Size size() const { return sensor_.depth.mean.size(); }
  bool haveSfm() const { return !sfm_.mean.empty(); }

  Inputs operator[](int y) const {
    const auto row = [&](const cv::Mat_<float>& image, const float* otherwise) {
      return image.empty() ? otherwise : image[y];
    };
    return {sensor_.depth.mean[y],          sensor_.depth.variance[y],    sensor_.surfaceVariance()[y],
            row(sensor_.raw, none_.data()), row(sfm_.mean, none_.data()), row(sfm_.variance, none_.data())};
  }

 private:
  const SensorDepth& sensor_;
  const GaussianDepth& sfm_;
  std::vector<float> none_;
};

struct Limits {
  float max_chi_squared, area_chi_squared, min_range;
  float max_relative_variance;  // of SfM depth that is averaged, per squared depth of the sensor
};

/// SfM's depth is of the surface that the sensor sees, and would contradict another one.
/// Comparisons with NaN are false, which settles where there is one depth only, or no surface is known.
inline bool confirms(float d, float surface_variance, float m, float vm, const Limits& limits) {
  const float difference = m - d;
  return (difference * difference <= limits.max_chi_squared * (surface_variance + vm)) &
         (vm <= limits.max_relative_variance * d * d);
}

/// Where each depth is from. Two that do not agree are left to the sensor.
RGBD_SFM_FUSION_MULTIVERSION
void classifyRow(const Inputs in, int width, const Limits limits, std::uint8_t* __restrict provenance,
                 std::uint8_t* __restrict disagreement) {
  for (int x = 0; x < width; ++x) {
    const float d = in.sensor_mean[x], m = in.sfm_mean[x], vm = in.sfm_variance[x], raw = in.raw[x];
    const float difference = m - d, square = difference * difference, to_raw = m - raw;
    const int sensor = d > 0.0f ? kSensor : 0;
    const int averaged = confirms(d, in.surface_variance[x], m, vm, limits) ? kSfm : 0;
    const int alone = ((m > 0.0f) & !(d > 0.0f)) ? kSfm : 0;
    const int contradicts = square > limits.max_chi_squared * (in.sensor_variance[x] + vm) ? kSensorWins : 0;
    const int too_near =
        ((raw < limits.min_range) & (to_raw * to_raw > limits.max_chi_squared * vm)) ? kTooNear : 0;
    provenance[x] = static_cast<std::uint8_t>(sensor | averaged | alone);
    disagreement[x] = static_cast<std::uint8_t>(contradicts | too_near);
  }
}

/// What each pixel says of its area. A depth that is too near is as good as exact.
RGBD_SFM_FUSION_MULTIVERSION
void voteRow(const Inputs in, int width, const Limits limits, std::uint8_t* __restrict vote) {
  for (int x = 0; x < width; ++x) {
    const float raw = in.raw[x];
    const bool too_near = raw < limits.min_range;
    const float d = too_near ? raw : in.sensor_mean[x], vd = too_near ? 0.0f : in.sensor_variance[x];
    const float difference = in.sfm_mean[x] - d, square = difference * difference;
    const int both = square >= 0.0f ? kBoth : 0;
    const int against = square > limits.area_chi_squared * (vd + in.sfm_variance[x]) ? kAgainst : 0;
    vote[x] = static_cast<std::uint8_t>(both | against);
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

void count(GaussianFusion* result) {
  for (int y = 0; y < result->provenance.rows; ++y) {
    RowCounts row;
    countRow(result->provenance[y], result->disagreement[y], result->provenance.cols, &row);
    result->counts += ProvenanceCounts{static_cast<std::uint64_t>(row.with_sensor - row.fused),
                                       static_cast<std::uint64_t>(row.with_sfm - row.fused),
                                       static_cast<std::uint64_t>(row.fused)};
    result->disagreeing += static_cast<std::uint64_t>(row.disagreeing);
  }
}

void classify(const Rows& rows, float min_range, const GaussianFusionOptions& options,
              GaussianFusion* result) {
  const float max_chi_squared =
      options.test_agreement ? static_cast<float>(options.max_chi_squared) : kNoLimit;
  const Limits limits{max_chi_squared, std::min(kAreaChiSquared, max_chi_squared), min_range,
                      options.test_agreement ? kLargestRelativeSigma * kLargestRelativeSigma : kNoLimit};
  const cv::Size size = rows.size();
  for (int y = 0; y < size.height; ++y) {
    const Inputs in = rows[y];
    classifyRow(in, size.width, limits, result->provenance[y], result->disagreement[y]);
    if (rows.haveSfm()) voteRow(in, size.width, limits, result->votes[y]);
  }
  count(result);
}

/// Takes one of two depths instead of what was taken.
void take(int source, int x, int y, GaussianFusion* result) {
  const auto counter = [&](int from) -> std::uint64_t& {
    ProvenanceCounts& counts = result->counts;
    return from == kFused ? counts.fused : (from == kSfm ? counts.sfm_only : counts.sensor_only);
  };
  --counter(result->provenance(y, x));
  ++counter(source);
  result->provenance(y, x) = static_cast<std::uint8_t>(source);
}

/// Says that a pixel's depths contradict each other.
void flag(Disagreement winner, int x, int y, GaussianFusion* result) {
  result->disagreeing += result->disagreement(y, x) == 0 ? 1u : 0u;
  result->disagreement(y, x) = static_cast<std::uint8_t>(winner);
}

/// Where much of an area is against it, nothing in it is averaged. Nor is a handful of pixels with nothing
/// around it: false matches come in such handfuls, and one that happens to agree confirms nothing.
void settleAreas(const SensorDepth& sensor, GaussianFusion* result) {
  const cv::Mat_<std::uint8_t>& votes = result->votes;
  const AreaVerdicts verdicts = judgeAreas(votes);
  forEachPixel(verdicts.contested, votes.size(), [&](int x, int y) {
    if (votes(y, x) == 0 || result->disagreement(y, x) != 0) return;
    const bool measured = sensor.depth.mean(y, x) > 0.0f;
    take(measured ? kSensor : kSfm, x, y, result);
    flag(measured ? Disagreement::kSensorKept : Disagreement::kSfmKept, x, y, result);
  });
  forEachPixel(verdicts.sparse, votes.size(), [&](int x, int y) {
    if (result->provenance(y, x) == kFused) take(kSensor, x, y, result);
  });
}

/// Gives each pixel of a row what its cell has.
RGBD_SFM_FUSION_MULTIVERSION
void spreadRow(const float* cells, int count, float* __restrict pixels) {
  for (int cell = 0; cell < count; ++cell) {
    for (int i = 0; i < CommonErrors::kCell; ++i) pixels[CommonErrors::kCell * cell + i] = cells[cell];
  }
}

/// What SfM's errors have in common around each pixel of a row; see CommonErrors.
struct RowErrors {
  std::vector<float> difference, noise_variance;

  /// Nothing is known.
  explicit RowErrors(int width)
      : difference(static_cast<std::size_t>(width + CommonErrors::kCell), 0.0f),
        noise_variance(difference.size(), std::numeric_limits<float>::infinity()) {}

  void set(const CommonErrors& errors, int y) {
    if (errors.difference.empty()) return;
    const int row = y / CommonErrors::kCell, count = errors.difference.cols;
    spreadRow(errors.difference[row], count, difference.data());
    spreadRow(errors.noise_variance[row], count, noise_variance.data());
  }
};

/// Eq. 11 and 12, of SfM's depth less the error that it has in common with its surroundings; or the one
/// depth that is taken.
RGBD_SFM_FUSION_MULTIVERSION
void fuseRow(const Inputs in, const RowErrors& errors, const std::uint8_t* provenance, int width,
             const DepthNoiseModel noise, float* __restrict mean, float* __restrict variance) {
  const float common_variance = noise.common_scale_sigma * noise.common_scale_sigma;
  const float *difference = errors.difference.data(), *noise_variance = errors.noise_variance.data();
  for (int x = 0; x < width; ++x) {
    const float d = in.sensor_mean[x], vd = in.sensor_variance[x], vs = in.surface_variance[x];
    const float m = in.sfm_mean[x], vm = in.sfm_variance[x];
    const float common = CommonErrors::kShare * vm, squared = m * m;
    const float known = common / (common + noise_variance[x] * squared * squared);
    const float found = known * difference[x] * m;  // of the inverse depth
    const float error = lesser(greater(found, -kLargestError), kLargestError);
    const float stretch = 1.0f + error + error * error;  // 1 / (1 - error)
    const float stretch_squared = stretch * stretch;
    const float aligned = m * stretch;
    const float aligned_variance = (vm - known * common) * stretch_squared * stretch_squared;
    const float gain = vs / (vs + aligned_variance);
    const float product = gain * aligned_variance;
    const float least = vs < vm ? vs : vm;  // above which rounding or stretching could bring the product
    const bool averaged = provenance[x] == kFused, has_sensor = d > 0.0f;
    const float z = averaged ? d + gain * (aligned - d) : (has_sensor ? d : m);
    // Weighted as the sensor's far depth deserves; its bias stays whole, as averaging more depth would not
    // end it.
    const float sensor_share = 1.0f - gain;
    const float bias = noise.farVariance(d) * (1.0f - sensor_share * sensor_share);
    const float v = averaged ? (product < least ? product : least) + bias : (has_sensor ? vd : vm);
    mean[x] = z;
    variance[x] = v + common_variance * z * z;
  }
}

void average(const Rows& rows, const CommonErrors& errors, const DepthNoiseModel& noise,
             GaussianFusion* result) {
  RowErrors row_errors(rows.size().width);
  for (int y = 0; y < rows.size().height; ++y) {
    if (y % CommonErrors::kCell == 0) row_errors.set(errors, y);
    fuseRow(rows[y], row_errors, result->provenance[y], rows.size().width, noise, result->depth.mean[y],
            result->depth.variance[y]);
  }
}

/// Much of what both see contradicts: pose or scale is wrong.
bool mostlyDisagrees(const GaussianFusion& result, double max_disagreement) {
  const std::uint64_t overlap = result.counts.fused + result.disagreeing;
  const double share = static_cast<double>(result.disagreeing) / static_cast<double>(overlap);
  return overlap >= kLeastOverlap && share > max_disagreement;
}

}  // namespace

GaussianFusion fuse(const SensorDepth& sensor, const GaussianDepth& sfm, const GaussianFusionOptions& options,
                    GaussianFusion buffer) {
  const cv::Size size = sensor.depth.mean.size();
  GaussianFusion result = std::move(buffer);
  result.counts = {};
  result.disagreeing = 0;
  result.sfm_rejected = false;
  result.depth.mean.create(size);
  result.depth.variance.create(size);
  result.provenance.create(size);
  result.disagreement.create(size);
  result.votes.create(size);
  const Rows rows(sensor, sfm);
  classify(rows, sensor.noise.min_range, options, &result);
  CommonErrors errors;
  if (!sfm.mean.empty() && options.test_agreement) {
    if (mostlyDisagrees(result, options.max_disagreement)) {
      GaussianFusion sensor_only = fuse(sensor, {}, options);
      // Where the sensor's depth is too near there is none to keep, either.
      const cv::Mat kept = (result.disagreement != 0) & (sensor_only.provenance == kSensor);
      sensor_only.disagreement.setTo(static_cast<double>(kSensorWins), kept);
      sensor_only.disagreeing = static_cast<std::uint64_t>(cv::countNonZero(kept));
      sensor_only.sfm_rejected = true;
      return sensor_only;
    }
    settleAreas(sensor, &result);
    if (options.align_locally) errors = commonErrors(sensor, sfm.mean, result.provenance);
  }
  average(rows, errors, sensor.noise, &result);
  return result;
}

}  // namespace rgbd_sfm_fusion
