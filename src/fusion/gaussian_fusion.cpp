// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/gaussian_fusion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "rgbd_sfm_fusion/fusion/evidence.h"
#include "rgbd_sfm_fusion/fusion/rough_logarithm.h"
#include "rgbd_sfm_fusion/geometry/row_points.h"
#include "rgbd_sfm_fusion/sensor/lateral_variance.h"
#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kSensor = static_cast<int>(Provenance::kSensor);
constexpr int kSfm = static_cast<int>(Provenance::kSfm);
constexpr int kFused = static_cast<int>(Provenance::kFused);
constexpr int kSensorKept = static_cast<int>(Disagreement::kSensorKept);
constexpr int kSfmKept = static_cast<int>(Disagreement::kSfmKept);
static_assert(kFused == (kSensor | kSfm), "fused is both");

/// -2 ln of a likelihood ratio, but for the constant in limitsOf(): how likely the difference is between
/// depths of one surface, N(difference; 0, variance), over how likely it is between depths of two, where the
/// other one may be anywhere within d: 1/d. Small where depths agree and are certain.
inline float unlikeliness(float square, float variance, float d) {
  return square / variance + roughLogarithm(variance / (d * d));
}

/// Depths up to `averaged` are averaged, and those above `contradicts` contradict each other.
struct Limits {
  float averaged, contradicts;
};

/// What is known of each SfM point of a row.
struct PointsOfRow {
  const int* columns;
  const float *sfm, *sfm_variance, *sensor, *sensor_variance, *surface_variance, *of_any_range;
  int count;

  /// What follows the points fills them up to full blocks.
  int padded() const { return paddedToLanes(count); }
};

PointsOfRow pointsOfRow(const SfmPoints& points, int y) {
  const std::size_t begin = points.begin(y);
  return {points.columns.data() + begin,         points.sfm.data() + begin,
          points.sfm_variance.data() + begin,    points.sensor.data() + begin,
          points.sensor_variance.data() + begin, points.surface_variance.data() + begin,
          points.of_any_range.data() + begin,    static_cast<int>(points.end(y) - begin)};
}

/// Evidence around each point of a row (see Evidence), and what becomes of the point.
struct RowResults {
  std::vector<float> odds, difference, noise_variance;
  std::vector<float> mean, variance;
  std::vector<std::uint8_t> provenance, disagreement;

  /// Starts without evidence.
  explicit RowResults(int width)
      : odds(static_cast<std::size_t>(paddedToLanes(width)), 0.0f),
        difference(odds.size(), 0.0f),
        noise_variance(odds.size(), std::numeric_limits<float>::infinity()),
        mean(odds.size()),
        variance(odds.size()),
        provenance(odds.size()),
        disagreement(odds.size()) {}

  void set(const Evidence& evidence, bool align_locally, int y, const PointsOfRow& points) {
    const int row = y / Evidence::kCell;
    takeOfCells(evidence.odds[row], points, odds.data());
    if (!align_locally) return;
    takeOfCells(evidence.difference[row], points, difference.data());
    takeOfCells(evidence.noise_variance[row], points, noise_variance.data());
  }

 private:
  /// The values of the cells that the points are in.
  static void takeOfCells(const float* cells, const PointsOfRow& points, float* __restrict values) {
    for (int i = 0; i < points.count; ++i)
      values[i] = cells[static_cast<unsigned>(points.columns[i]) / Evidence::kCell];
  }
};

/// Decides the source of each depth. Where the two depths exceed `averaged`, the sensor's is taken.
RGBD_SFM_FUSION_MULTIVERSION
void classify(const PointsOfRow in, const float* odds, const Limits limits, float min_range,
              std::uint8_t* __restrict provenance, std::uint8_t* __restrict disagreement) {
  for (int i = 0, end = in.padded(); i < end; ++i) {
    const float d = in.sensor[i], m = in.sfm[i], vm = in.sfm_variance[i], any = in.of_any_range[i];
    const bool too_near = any < min_range;
    const float measured = too_near ? any : d, vd = too_near ? 0.0f : in.sensor_variance[i];
    const float difference = m - d, off = m - measured, around = 2.0f * odds[i];
    const bool averaged =
        unlikeliness(difference * difference, in.surface_variance[i] + vm, d) <= limits.averaged + around;
    const bool contradicts = unlikeliness(off * off, vd + vm, measured) > limits.contradicts + around;
    const int sensor = d > 0.0f ? kSensor : 0;
    const bool alone = (m > 0.0f) & !(d > 0.0f);
    provenance[i] = static_cast<std::uint8_t>(averaged | alone ? sensor | kSfm : sensor);
    disagreement[i] =
        static_cast<std::uint8_t>(contradicts & !averaged ? (too_near ? kSfmKept : kSensorKept) : 0);
  }
}

/// All pixels with both depths are averaged, as in the paper.
RGBD_SFM_FUSION_MULTIVERSION
void takeAll(const PointsOfRow in, std::uint8_t* __restrict provenance,
             std::uint8_t* __restrict disagreement) {
  for (int i = 0, end = in.padded(); i < end; ++i) {
    const int sensor = in.sensor[i] > 0.0f ? kSensor : 0, sfm = in.sfm[i] > 0.0f ? kSfm : 0;
    provenance[i] = static_cast<std::uint8_t>(sensor | sfm);
    disagreement[i] = 0;
  }
}

/// @param min_probability  of depths that are averaged
Limits limitsOf(double min_probability) {
  const double p = std::max(min_probability, 0.5);  // below 1/2, two surfaces are more probable
  const double even = -std::log(2.0 * M_PI);        // where both are as likely
  return {static_cast<float>(even - 2.0 * std::log(p / (1.0 - p))), static_cast<float>(even)};
}

/// The sensor's depth alone, with the errors that all of its depths share.
/// @return how many pixels have depth
RGBD_SFM_FUSION_MULTIVERSION
int takeSensorRow(const float* sensor, const float* sensor_variance, int width, const DepthNoiseModel noise,
                  float* __restrict mean, float* __restrict variance, std::uint8_t* __restrict provenance) {
  int count = 0;
  for (int x = 0; x < width; ++x) {
    const float z = sensor[x];
    const int has_depth = z > 0.0f ? kSensor : 0;
    mean[x] = z;
    variance[x] = sensor_variance[x] + noise.commonVariance(z);
    provenance[x] = static_cast<std::uint8_t>(has_depth);
    count += has_depth;
  }
  return count;
}

/// Eq. 11 and 12, with SfM's depth corrected by the error that it shares with its surroundings. Where a pixel
/// is not averaged, the depth that was chosen.
RGBD_SFM_FUSION_MULTIVERSION
void combine(const PointsOfRow in, const float* difference, const float* noise_variance,
             const std::uint8_t* provenance, const DepthNoiseModel noise, const SensorOffsetGain offset,
             float* __restrict mean, float* __restrict variance) {
  const float scale_variance = noise.common_scale_sigma * noise.common_scale_sigma;
  const float offset_variance = noise.common_offset_sigma * noise.common_offset_sigma;
  for (int i = 0, end = in.padded(); i < end; ++i) {
    const float d = in.sensor[i], vd = in.sensor_variance[i], vs = in.surface_variance[i];
    const float m = in.sfm[i], vm = in.sfm_variance[i];
    const float common = Evidence::kShare * vm, squared = m * m;
    const float shown = common / (common + noise_variance[i] * squared * squared);  // s of evidence.h
    const float found = shown * difference[i] * m;                // share of the inverse depth
    const float most = kLargestByChance * std::sqrt(common) / m;  // beyond, it is no error that is common
    const float error = lesser(greater(found, -most), most);
    const float stretch = 1.0f + error + error * error;  // about 1 / (1 - error)
    const float stretch_squared = stretch * stretch;
    const float corrected = m * stretch;
    const float corrected_variance = (vm - shown * common) * stretch_squared * stretch_squared;
    const float gain = vs / (vs + corrected_variance);
    const float product = gain * corrected_variance;  // Eq. 12
    const float least = vs < vm ? vs : vm;            // rounding or stretching could make the product larger
    const bool averaged = provenance[i] == kFused, has_sensor = d > 0.0f;
    // Eq. 11, where the two are averaged.
    const float z = averaged ? d + gain * (corrected - d) : (has_sensor ? d : m);
    // The weights contain the bias of the sensor's far depth, and the variance gets all of it: SfM's depth is
    // averaged only where it agrees with such depth.
    const float sensor_share = 1.0f - gain;
    const float bias = noise.farVariance(d) * (1.0f - sensor_share * sensor_share);
    const float v = averaged ? (product < least ? product : least) + bias : (has_sensor ? vd : vm);
    mean[i] = z;
    const float of_sfm =
        (offset.base + offset.x_gain * static_cast<float>(in.columns[i])) * z + offset.relative;
    const float by_offset = has_sensor ? z : of_sfm;
    variance[i] = v + (scale_variance + offset_variance * by_offset * by_offset) * z * z;
  }
}

/// How many of a row's points have a value.
RGBD_SFM_FUSION_MULTIVERSION
int countOf(const std::uint8_t* values, int count, int value) {
  int found = 0;
  for (int i = 0; i < count; ++i) found += values[i] == value ? 1 : 0;
  return found;
}

/// Writes the points into the row, and counts them.
/// @param with_sensor  [px] of the row
void writeRow(const PointsOfRow& points, const RowResults& row, int with_sensor, int y, FusedDepth* result) {
  float *const mean = result->depth.mean[y], *const variance = result->depth.variance[y];
  std::uint8_t *const provenance = result->provenance[y], *const disagreement = result->disagreement[y];
  for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i) {
    const int x = points.columns[i];
    mean[x] = row.mean[i];
    variance[x] = row.variance[i];
    provenance[x] = row.provenance[i];
    disagreement[x] = row.disagreement[i];
  }
  const int sfm_only = countOf(row.provenance.data(), points.count, kSfm),
            fused = countOf(row.provenance.data(), points.count, kFused),
            disagreeing = points.count - countOf(row.disagreement.data(), points.count, 0);
  result->counts += ProvenanceCounts{static_cast<std::uint64_t>(with_sensor - fused),
                                     static_cast<std::uint64_t>(sfm_only), static_cast<std::uint64_t>(fused)};
  result->disagreeing += static_cast<std::uint64_t>(disagreeing);
}

/// Marks pixels without depth that have a stray.
RGBD_SFM_FUSION_MULTIVERSION
void markFreeStrays(const float* credible, const std::uint8_t* provenance, int width,
                    std::uint8_t* __restrict marks) {
  for (int x = 0; x < width; ++x) marks[x] = (credible[x] > 0.0f) & (provenance[x] == 0) ? 1 : 0;
}

}  // namespace

FusedDepth fuse(const SensorDepth& sensor, const SfmPoints& sfm, const GaussianFusionOptions& options,
                FusedDepth buffer, const SensorOffsetGain& gain) {
  const cv::Size size = sensor.depth.mean.size();
  FusedDepth result = std::move(buffer);
  result.counts = {};
  result.disagreeing = 0;
  result.depth.mean.create(size);
  result.depth.variance.create(size);
  result.provenance.create(size);
  result.disagreement.create(size);
  const bool weighs = options.test_agreement && sfm.size() > 0;
  Evidence evidence;
  if (weighs) evidence = evidenceAround(sensor, sfm, static_cast<float>(options.max_chi_squared));
  const Limits limits = limitsOf(options.min_inlier_probability);
  const DepthNoiseModel& noise = sensor.noise;
  RowResults row(size.width);
  for (int y = 0; y < size.height; ++y) {
    const PointsOfRow points = pointsOfRow(sfm, y);
    if (weighs) {
      row.set(evidence, options.align_locally, y, points);
      classify(points, row.odds.data(), limits, noise.min_range, row.provenance.data(),
               row.disagreement.data());
    } else {
      takeAll(points, row.provenance.data(), row.disagreement.data());
    }
    SensorOffsetGain of_row = gain;
    of_row.base += gain.y_gain * static_cast<float>(y);
    combine(points, row.difference.data(), row.noise_variance.data(), row.provenance.data(), noise, of_row,
            row.mean.data(), row.variance.data());
    const int with_sensor =
        takeSensorRow(sensor.depth.mean[y], sensor.depth.variance[y], size.width, noise, result.depth.mean[y],
                      result.depth.variance[y], result.provenance[y]);
    std::fill_n(result.disagreement[y], size.width, std::uint8_t{0});
    writeRow(points, row, with_sensor, y, &result);
  }
  return result;
}

FusedDepth sensorAlone(const SensorDepth& sensor, const FusedDepth& contradicting, FusedDepth buffer) {
  FusedDepth result = fuse(sensor, SfmPoints(), {}, std::move(buffer));
  const cv::Mat kept = (contradicting.disagreement != 0) & (result.provenance == kSensor);
  result.disagreement.setTo(kSensorKept, kept);
  result.disagreeing = static_cast<std::uint64_t>(cv::countNonZero(kept));
  return result;
}

void takeStrays(const SensorDepth& sensor, FusedDepth* fused) {
  constexpr float kRelativeVariance = kMaxRelativeSigma * kMaxRelativeSigma;
  if (sensor.credible.data == sensor.of_any_range.data) return;  // there are none
  const int width = sensor.credible.cols;
  std::vector<std::uint8_t> marks(static_cast<std::size_t>(paddedToLanes(width)));
  std::vector<int> columns(marks.size());
  std::uint64_t taken = 0;
  for (int y = 0; y < sensor.credible.rows; ++y) {
    const float* const credible = sensor.credible[y];
    markFreeStrays(credible, fused->provenance[y], width, marks.data());
    const int count = findMarks(marks.data(), 0, width, columns.data());
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const int x = columns[i];
      const float z = credible[x];
      if (std::isnan(sensor.noise.variance(z))) continue;
      fused->depth.mean(y, x) = z;
      fused->depth.variance(y, x) = kRelativeVariance * z * z + sensor.noise.commonVariance(z);
      fused->provenance(y, x) = kSensor;
      ++taken;
    }
  }
  fused->counts.sensor_only += taken;
  fused->counts.without -= taken;
}

}  // namespace rgbd_sfm_fusion
