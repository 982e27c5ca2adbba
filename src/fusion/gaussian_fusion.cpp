// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/gaussian_fusion.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
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

constexpr int kCell = 4;          // [px] of the grid on which areas are looked at
constexpr int kLeastPixels = 12;  // with both depths; fewer say nothing of an area

/// σ of SfM depth beyond which it is not averaged, as a share of the sensor's depth. The sensor's own is a
/// sixth of that at the end of its range, and less before: nothing would be gained, and SfM would agree with
/// what is a tenth nearer or farther, too.
constexpr float kLargestRelativeSigma = 0.045f;

/// A smaller overlap says nothing about the frame as a whole.
constexpr std::uint64_t kLeastOverlap = 200;  // [px]

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

/// What there is of each pixel of a row; 0 or NaN = none.
struct Inputs {
  const float *sensor_mean, *sensor_variance, *surface_variance, *raw, *sfm_mean, *sfm_variance;
};

struct Limits {
  float max_chi_squared, area_chi_squared, min_range, common_variance;
  float max_relative_variance;  // of SfM depth that is averaged, per squared depth of the sensor
};

/// What a pixel with both depths says of its area, bit by bit.
constexpr int kBoth = 1, kAgainst = 2;

/// SfM's depth is of the surface that the sensor sees, and would contradict another one.
/// Comparisons with NaN are false, which settles where there is one depth only, or no surface is known.
inline bool confirms(float d, float surface_variance, float m, float vm, const Limits& limits) {
  const float difference = m - d;
  return (difference * difference <= limits.max_chi_squared * (surface_variance + vm)) &
         (vm <= limits.max_relative_variance * d * d);
}

/// Eq. 13 and 14. Depths that do not agree are left to the sensor.
RGBD_SFM_FUSION_MULTIVERSION
void fuseRow(const Inputs in, int width, const Limits limits, float* __restrict mean,
             float* __restrict variance) {
  for (int x = 0; x < width; ++x) {
    const float d = in.sensor_mean[x], vd = in.sensor_variance[x], vs = in.surface_variance[x];
    const float m = in.sfm_mean[x], vm = in.sfm_variance[x];
    const float sum = vs + vm, difference = m - d;
    const float gain = vs / sum;
    const float product = gain * vm;  // not above either, but for rounding
    const float least = vs < vm ? vs : vm;
    const bool agree = confirms(d, vs, m, vm, limits);
    const bool has_sensor = d > 0.0f;
    const float z = agree ? d + gain * difference : (has_sensor ? d : m);
    const float v = agree ? (product < least ? product : least) : (has_sensor ? vd : vm);
    mean[x] = z;
    variance[x] = v + limits.common_variance * z * z;
  }
}

/// Where each depth of fuseRow() is from.
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

/// Takes one of two depths instead of what was taken.
void take(const GaussianDepth& depth, int source, int x, int y, float common_variance,
          GaussianFusion* result) {
  const auto counter = [&](int from) -> std::uint64_t& {
    ProvenanceCounts& counts = result->counts;
    return from == kFused ? counts.fused : (from == kSfm ? counts.sfm_only : counts.sensor_only);
  };
  const float z = depth.mean(y, x);
  result->depth.mean(y, x) = z;
  result->depth.variance(y, x) = depth.variance(y, x) + common_variance * z * z;
  --counter(result->provenance(y, x));
  ++counter(source);
  result->provenance(y, x) = static_cast<std::uint8_t>(source);
}

/// Says that a pixel's depths contradict each other.
void flag(Disagreement winner, int x, int y, GaussianFusion* result) {
  result->disagreeing += result->disagreement(y, x) == 0 ? 1u : 0u;
  result->disagreement(y, x) = static_cast<std::uint8_t>(winner);
}

/// Adds up the votes of a row in cells of kCell pixels.
RGBD_SFM_FUSION_MULTIVERSION
void addToCells(const std::uint8_t* votes, int cells, std::uint16_t* __restrict both,
                std::uint16_t* __restrict against) {
  constexpr std::uint32_t kEach = 0x01010101;
  for (int cell = 0; cell < cells; ++cell) {
    std::uint32_t word;
    std::memcpy(&word, votes + kCell * cell, sizeof(word));
    both[cell] = static_cast<std::uint16_t>(both[cell] + ((word & kEach) * kEach >> 24));
    against[cell] = static_cast<std::uint16_t>(against[cell] + ((word >> 1 & kEach) * kEach >> 24));
  }
}

/// Pixels with both depths in the area of each cell, and those of them that are against their being one.
struct AreaVotes {
  cv::Mat_<std::uint16_t> both, against;
};

/// A cell's area is that of the two cells around it on each side, too.
AreaVotes sumAreas(const cv::Mat_<std::uint8_t>& votes) {
  cv::Mat_<std::uint16_t> both(votes.rows / kCell + 1, votes.cols / kCell + 1);
  both.setTo(0.0);
  cv::Mat_<std::uint16_t> against = both.clone();
  for (int y = 0; y < votes.rows; ++y)
    addToCells(votes[y], votes.cols / kCell, both[y / kCell], against[y / kCell]);
  const cv::Size window(5, 5);
  AreaVotes areas;
  cv::boxFilter(both, areas.both, -1, window, {-1, -1}, false, cv::BORDER_CONSTANT);
  cv::boxFilter(against, areas.against, -1, window, {-1, -1}, false, cv::BORDER_CONSTANT);
  return areas;
}

/// Many of the pixels with both depths are against their being one.
bool isContested(int both, int against) {
  return against >= kLeastPixels && 5 * against >= 2 * both;
}

/// Cells whose area is contested; and those beside these, since sensor depth is not seen from where the
/// colour is, nor at the same time.
cv::Mat_<std::uint8_t> contestedCells(const AreaVotes& areas) {
  cv::Mat_<std::uint8_t> contested(areas.both.size());
  for (int y = 0; y < contested.rows; ++y) {
    for (int x = 0; x < contested.cols; ++x)
      contested(y, x) = isContested(areas.both(y, x), areas.against(y, x)) ? 1 : 0;
  }
  cv::dilate(contested, contested, cv::Mat());
  return contested;
}

/// Cells in whose area SfM has a handful of pixels only.
cv::Mat_<std::uint8_t> sparseCells(const AreaVotes& areas) {
  cv::Mat_<std::uint8_t> sparse;
  cv::inRange(areas.both, 1.0, static_cast<double>(kLeastPixels - 1), sparse);
  return sparse;
}

/// Calls settle(x, y) for what is in the cells that are not 0.
template <typename Settle>
void forEachPixel(const cv::Mat_<std::uint8_t>& cells, const cv::Size& size, const Settle& settle) {
  const cv::Rect image({0, 0}, size);
  for (int row = 0; row < cells.rows; ++row) {
    for (int column = 0; column < cells.cols; ++column) {
      if (cells(row, column) == 0) continue;
      const cv::Rect pixels = cv::Rect(column * kCell, row * kCell, kCell, kCell) & image;
      for (int y = pixels.y; y < pixels.br().y; ++y) {
        for (int x = pixels.x; x < pixels.br().x; ++x) settle(x, y);
      }
    }
  }
}

/// Where much of an area is against it, nothing in it is averaged. Nor is a handful of pixels with nothing
/// around it: false matches come in such handfuls, and one that happens to agree confirms nothing.
void settleAreas(const SensorDepth& sensor, const GaussianDepth& sfm, const cv::Mat_<std::uint8_t>& votes,
                 float common_variance, GaussianFusion* result) {
  const AreaVotes areas = sumAreas(votes);
  forEachPixel(contestedCells(areas), votes.size(), [&](int x, int y) {
    if (votes(y, x) == 0 || result->disagreement(y, x) != 0) return;
    const bool measured = sensor.depth.mean(y, x) > 0.0f;
    take(measured ? sensor.depth : sfm, measured ? kSensor : kSfm, x, y, common_variance, result);
    flag(measured ? Disagreement::kSensorKept : Disagreement::kSfmKept, x, y, result);
  });
  forEachPixel(sparseCells(areas), votes.size(), [&](int x, int y) {
    if (result->provenance(y, x) == kFused) take(sensor.depth, kSensor, x, y, common_variance, result);
  });
}

/// Much of what both see contradicts: pose or scale is wrong.
bool mostlyDisagrees(const GaussianFusion& result, double max_disagreement) {
  const std::uint64_t overlap = result.counts.fused + result.disagreeing;
  const double share = static_cast<double>(result.disagreeing) / static_cast<double>(overlap);
  return overlap >= kLeastOverlap && share > max_disagreement;
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

GaussianFusion fuse(const SensorDepth& sensor, const GaussianDepth& sfm, double common_scale_sigma,
                    const GaussianFusionOptions& options, GaussianFusion buffer) {
  const cv::Size size = sensor.depth.mean.size();
  GaussianFusion result = std::move(buffer);
  result.counts = {};
  result.disagreeing = 0;
  result.sfm_rejected = false;
  result.depth.mean.create(size);
  result.depth.variance.create(size);
  result.provenance.create(size);
  result.disagreement.create(size);
  const float max_chi_squared =
      options.test_agreement ? static_cast<float>(options.max_chi_squared) : kNoLimit;
  const Limits limits{max_chi_squared, std::min(kAreaChiSquared, max_chi_squared), sensor.min_range,
                      static_cast<float>(common_scale_sigma * common_scale_sigma),
                      options.test_agreement ? kLargestRelativeSigma * kLargestRelativeSigma : kNoLimit};
  cv::Mat_<std::uint8_t>& votes = result.votes;
  votes.create(size);
  const std::vector<float> none(static_cast<std::size_t>(size.width), kNone);
  const auto row = [&](const cv::Mat_<float>& image, int y, const float* otherwise) {
    return image.empty() ? otherwise : image[y];
  };
  for (int y = 0; y < size.height; ++y) {
    const float* variance = sensor.depth.variance[y];
    const Inputs in{sensor.depth.mean[y],
                    variance,
                    row(sensor.surface_variance, y, variance),
                    row(sensor.raw, y, none.data()),
                    row(sfm.mean, y, none.data()),
                    row(sfm.variance, y, none.data())};
    fuseRow(in, size.width, limits, result.depth.mean[y], result.depth.variance[y]);
    classifyRow(in, size.width, limits, result.provenance[y], result.disagreement[y]);
    if (!sfm.mean.empty()) voteRow(in, size.width, limits, votes[y]);
  }
  count(&result);
  if (sfm.mean.empty() || !options.test_agreement) return result;
  if (mostlyDisagrees(result, options.max_disagreement)) {
    GaussianFusion sensor_only = fuse(sensor, {}, common_scale_sigma, options);
    sensor_only.disagreement.setTo(static_cast<double>(kSensorWins), result.disagreement != 0);
    sensor_only.disagreeing = result.disagreeing;
    sensor_only.sfm_rejected = true;
    return sensor_only;
  }
  settleAreas(sensor, sfm, votes, limits.common_variance, &result);
  return result;
}

}  // namespace rgbd_sfm_fusion
