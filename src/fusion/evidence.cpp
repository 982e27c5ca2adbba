// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/evidence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "rgbd_sfm_fusion/fusion/gaussian_fusion.h"
#include "rgbd_sfm_fusion/multiversion.h"
#include "rgbd_sfm_fusion/sensor/lateral_variance.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kCell = Evidence::kCell;

/// The four sums over pixels.
enum { kFor, kAgainst, kWeight, kWeighted, kSums };

/// Points [begin, end) of a row.
struct PointsOfRow {
  const float *sensor, *sensor_variance, *surface_variance, *sfm, *sfm_variance;
  int count;
};

/// Votes for and against; weight p of the difference of inverse depth (SfM less sensor); p times this
/// difference.
RGBD_SFM_FUSION_MULTIVERSION
void comparePoints(const PointsOfRow row, const DepthNoiseModel noise_model, float max_chi_squared,
                   float* __restrict agrees, float* __restrict against, float* __restrict weight,
                   float* __restrict weighted) {
  for (int i = 0; i < row.count; ++i) {
    const float d = row.sensor[i], vd = row.sensor_variance[i], v = row.surface_variance[i], m = row.sfm[i],
                vm = row.sfm_variance[i];
    const float chi_squared = (m - d) * (m - d);  // NaN unless the pixel has both depths
    const bool one = chi_squared <= max_chi_squared * (v + vm);
    const bool two = chi_squared > max_chi_squared * (vd + vm);
    agrees[i] = one ? 1.0f : 0.0f;
    against[i] = two ? 1.0f : 0.0f;
    const float squared = d * d, sigma = noise_model.quadratic * squared;
    const float model = sigma * sigma + noise_model.floor * noise_model.floor;
    const float noise = model < v ? model : v;
    const float inverse = 1.0f / (v * v * m);  // one division for both weights
    const float scaled = noise * squared * d * inverse;
    const bool averaged = one & (d <= noise_model.max_range);
    weight[i] = averaged ? scaled * d * m : 0.0f;
    weighted[i] = averaged ? scaled * (d - m) : 0.0f;
  }
}

/// Sums over the cells around.
cv::Mat_<float> around(const cv::Mat_<float>& sums) {
  static const cv::Matx13f weights(0.5f, 1.0f, 0.5f);
  cv::Mat_<float> result;
  cv::sepFilter2D(sums, result, -1, weights, weights, {-1, -1}, 0.0, cv::BORDER_CONSTANT);
  return result;
}

constexpr int kSpacing = AgreementStatistics::kSpacing;
constexpr int kRadius = AgreementStatistics::kBeside * kSpacing;  // [px] of the neighbours that may agree
constexpr float kStep = kStepRatio * kSpacing;  // least step between the surfaces of two neighbours
constexpr double kPriorPixels = 50.0;           // [px] weight of the prior
constexpr int kReach = 12;                      // [px] widest gap between a surface and the surface behind it
constexpr double kEdgeOutlier = 0.05;           // see inlierProbability()

bool sameSurface(float a, float b) {
  return std::max(a, b) < (1.0F + kStep) * std::min(a, b);  // false where a is NaN
}

bool isBehind(float a, float b) {
  return a > (1.0F + kStep) * b;
}

/// Share of the prior's pessimism that is left with so many neighbours that agree.
double priorDecay(int agreeing) {
  static const auto table = [] {
    AgreementStatistics::ByAgreeing<double> values{};
    for (std::size_t n = 0; n < values.size(); ++n) values[n] = std::exp(-static_cast<double>(n) / 4.0);
    return values;
  }();
  return table[static_cast<std::size_t>(agreeing)];
}

/// Looks for surfaces behind the surface of a pixel.
class Scout {
 public:
  explicit Scout(const DepthImage& depth) : depth_(depth) {}

  /// [m] The farthest one beside; 0 = none is seen.
  float farther(const cv::Point& pixel) const {
    const float* const depth = depth_[pixel.y] + pixel.x;
    const auto row = static_cast<std::ptrdiff_t>(depth_.step1());
    return std::max({look(depth, 1, depth_.cols - 1 - pixel.x), look(depth, -1, pixel.x),
                     look(depth, row, depth_.rows - 1 - pixel.y), look(depth, -row, pixel.y)});
  }

 private:
  /// Walks along a row or column, to the end of the pixel's surface, and across a gap.
  /// @param room  [px] from the pixel to the border of the image
  static float look(const float* pixel, std::ptrdiff_t step, int room) {
    float z = *pixel;
    for (int distance = 1; distance <= std::min(kRadius, room); ++distance) {
      pixel += step;
      if (!sameSurface(*pixel, z)) return beyond(pixel, step, std::min(kReach, room - distance + 1), z);
      z = *pixel;
    }
    return 0.0F;
  }

  static float beyond(const float* pixel, std::ptrdiff_t step, int reach, float z) {
    for (int gap = 0; gap < reach; ++gap, pixel += step)
      if (*pixel > 0.0F) return isBehind(*pixel, z) ? *pixel : 0.0F;
    return 0.0F;
  }

  const DepthImage& depth_;
};

RGBD_SFM_FUSION_MULTIVERSION
void markMeasuredRow(const float* variance, int width, std::uint8_t* __restrict measured) {
  for (int x = 0; x < width; ++x) measured[x] = variance[x] > 0.0f ? 1 : 0;
}

RGBD_SFM_FUSION_MULTIVERSION
void addRow(const std::uint8_t* measured, int width, std::uint8_t* __restrict near) {
  for (int x = 0; x < width; ++x) near[x] = near[x] | measured[x];
}

RGBD_SFM_FUSION_MULTIVERSION
void dropRow(const std::uint8_t* near, const std::uint8_t* measured, int width, float* __restrict mean,
             float* __restrict variance) {
  for (int x = 0; x < width; ++x) {
    const bool rim = (near[x] != 0) & (measured[x] == 0);
    mean[x] = rim ? kNoDepth : mean[x];
    variance[x] = rim ? kNoDepth : variance[x];
  }
}

}  // namespace

Evidence evidenceAround(const SensorDepth& sensor, const SfmPoints& sfm, float max_chi_squared) {
  const cv::Size size = sensor.depth.mean.size();
  const cv::Size cells((size.width + kCell - 1) / kCell, (size.height + kCell - 1) / kCell);
  std::array<cv::Mat_<float>, kSums> sums;
  for (cv::Mat_<float>& sum : sums) sum = cv::Mat_<float>::zeros(cells);
  std::array<std::vector<float>, kSums> found;
  for (std::vector<float>& values : found) values.resize(static_cast<std::size_t>(size.width));
  for (int y = 0; y < size.height; ++y) {
    const std::size_t begin = sfm.begin(y), count = sfm.end(y) - begin;
    const auto from = [&](const std::vector<float>& values) { return values.data() + begin; };
    comparePoints({from(sfm.sensor), from(sfm.sensor_variance), from(sfm.surface_variance), from(sfm.sfm),
                   from(sfm.sfm_variance), static_cast<int>(count)},
                  sensor.noise, max_chi_squared, found[kFor].data(), found[kAgainst].data(),
                  found[kWeight].data(), found[kWeighted].data());
    for (std::size_t sum = 0; sum < kSums; ++sum) {
      float* const row = sums[sum][y / kCell];
      for (std::size_t i = 0; i < count; ++i) row[sfm.columns[begin + i] / kCell] += found[sum][i];
    }
  }
  const cv::Mat_<float> agree = around(sums[kFor]), against = around(sums[kAgainst]);
  const cv::Mat_<float> weights = around(sums[kWeight]), weighted = around(sums[kWeighted]);
  Evidence evidence{cv::Mat_<float>(agree.size()), cv::Mat_<float>(agree.size()),
                    cv::Mat_<float>(agree.size())};
  for (int row = 0; row < agree.rows; ++row) {
    for (int cell = 0; cell < agree.cols; ++cell) {
      // The two added votes are a uniform prior.
      evidence.odds(row, cell) = std::log((agree(row, cell) + 1.0f) / (against(row, cell) + 1.0f));
      const float p = weights(row, cell);
      evidence.difference(row, cell) = p > 0.0f ? weighted(row, cell) / p : 0.0f;
      evidence.noise_variance(row, cell) = static_cast<float>(Overlap::kPixelsOfOneError) / p;
    }
  }
  return evidence;
}

int agreeingNeighbours(const DepthImage& depth, const cv::Point& pixel) {
  const float z = depth(pixel);
  int count = -1;  // the pixel itself
  const bool inside = pixel.x >= kRadius && pixel.x < depth.cols - kRadius;
  for (int y = std::max(pixel.y - kRadius, pixel.y % kSpacing);
       y <= std::min(pixel.y + kRadius, depth.rows - 1); y += kSpacing) {
    const float* const row = depth[y] + pixel.x;
    for (int x = -kRadius; x <= kRadius; x += kSpacing) {
      const bool in_image = inside || (pixel.x + x >= 0 && pixel.x + x < depth.cols);
      count += in_image && sameSurface(row[x], z) ? 1 : 0;
    }
  }
  return std::max(count, 0);
}

void AgreementStatistics::observe(const SfmPoints& points, const DepthImage& sfm, float farthest) {
  ByAgreeing<Counts> frame;
  const std::size_t step = points.size() / Overlap::kMaxSamples + 1;
  std::size_t i = 0;
  for (int y = 0; y < sfm.rows; ++y) {
    for (; i < points.end(y); i += step) {
      if (!(points.sensor[i] <= farthest)) continue;
      const float error = points.sfm[i] - points.sensor[i];
      const float variance = points.sfm_variance[i] + points.sensor_variance[i];
      Counts& counts = frame[static_cast<std::size_t>(agreeingNeighbours(sfm, {points.columns[i], y}))];
      counts.pixels += 1.0;
      counts.outliers += std::abs(error) > AgreementStatistics::kRight * points.sensor[i] ? 1.0 : 0.0;
      counts.squares += static_cast<double>(
          std::min(error * error / variance, static_cast<float>(Overlap::kOutlierSquare)));
    }
  }
  for (std::size_t agreeing = 0; agreeing < frame.size(); ++agreeing) {
    const Counts& of_frame = frame[agreeing];
    if (of_frame.pixels == 0.0) continue;  // nothing new: the old counts stay
    Counts& known = seen_[agreeing];
    known.pixels = Overlap::kMemory * known.pixels + of_frame.pixels;
    known.outliers = Overlap::kMemory * known.outliers + of_frame.outliers;
    known.squares = Overlap::kMemory * known.squares + of_frame.squares;
  }
}

double AgreementStatistics::outlierShare(int agreeing) const {
  const double prior = 0.5 * priorDecay(agreeing);
  return (seen(agreeing).outliers + kPriorPixels * prior) / (seen(agreeing).pixels + kPriorPixels);
}

double AgreementStatistics::varianceFactor(int agreeing) const {
  const double prior = 1.0 + 4.0 * priorDecay(agreeing);
  const double factor =
      (seen(agreeing).squares + kPriorPixels * prior) / (seen(agreeing).pixels + kPriorPixels);
  return std::max(factor, static_cast<double>(Evidence::kShare));
}

double inlierProbability(const SfmOnlySurroundings& surroundings, const AgreementStatistics& statistics) {
  return 1.0 - statistics.outlierShare(surroundings.agreeing) -
         (surroundings.farther > 0.0F ? kEdgeOutlier : 0.0);
}

void judgeSfmOnly(const DepthImage& sfm, const AgreementStatistics& statistics, const SfmOnlyLimits& limits,
                  GaussianFusion& fusion) {
  struct Known {
    double probability;  // without a surface behind
    float factor;
  };
  AgreementStatistics::ByAgreeing<Known> by_agreeing;
  for (int n = 0; n < static_cast<int>(by_agreeing.size()); ++n)
    by_agreeing[static_cast<std::size_t>(n)] = {
        inlierProbability({n, 0.0F}, statistics),
        limits.correct_variance ? static_cast<float>(statistics.varianceFactor(n)) : 1.0F};
  const auto max_relative_variance =
      static_cast<float>(limits.max_relative_sigma * limits.max_relative_sigma);
  const Scout scout(fusion.depth.mean);
  std::vector<cv::Point> dropped;  // dropped at the end, so that the order of pixels does not matter
  const SfmPoints& points = fusion.points;
  for (int y = 0; y < fusion.provenance.rows; ++y) {
    for (std::size_t i = points.begin(y); i < points.end(y); ++i) {
      const int x = points.columns[i];
      if (points.sensor[i] > 0.0F || fusion.disagreement(y, x) != 0) continue;
      const Known& known = by_agreeing[static_cast<std::size_t>(agreeingNeighbours(sfm, {x, y}))];
      const float z = fusion.depth.mean(y, x);
      float& variance = fusion.depth.variance(y, x);
      variance *= known.factor;
      const auto isDropped = [&](double probability) {
        return probability < limits.min_probability || variance > max_relative_variance * z * z;
      };
      bool drop = isDropped(known.probability);  // what is around does not make it better
      if (!drop) {
        const float farther = scout.farther({x, y}), step = farther > 0.0F ? farther - z : 0.0F;
        variance += static_cast<float>(kEdgeOutlier) * step * step;
        drop = isDropped(known.probability - (farther > 0.0F ? kEdgeOutlier : 0.0));
      }
      if (drop) dropped.emplace_back(x, y);
    }
  }
  for (const cv::Point& pixel : dropped) {
    fusion.depth.mean(pixel) = fusion.depth.variance(pixel) = kNoDepth;
    fusion.provenance(pixel) = static_cast<std::uint8_t>(Provenance::kNone);
  }
  fusion.counts.sfm_only -= dropped.size();
}

void dropAtRims(const GaussianDepth& sensor, int width, GaussianDepth& sfm) {
  if (width == 0) return;
  const cv::Size size = sfm.mean.size();
  cv::Mat_<std::uint8_t> measured(size);
  for (int y = 0; y < size.height; ++y) markMeasuredRow(sensor.variance[y], size.width, measured[y]);
  // Nothing is measured beyond the sides of the image.
  std::vector<std::uint8_t> column(static_cast<std::size_t>(size.width + 2 * width));
  std::vector<std::uint8_t> near(static_cast<std::size_t>(size.width));
  for (int y = 0; y < size.height; ++y) {
    std::fill(column.begin(), column.end(), std::uint8_t{0});
    for (int row = std::max(y - width, 0); row <= std::min(y + width, size.height - 1); ++row)
      addRow(measured[row], size.width, column.data() + width);
    std::fill(near.begin(), near.end(), std::uint8_t{0});
    for (int x = 0; x <= 2 * width; ++x) addRow(column.data() + x, size.width, near.data());
    dropRow(near.data(), measured[y], size.width, sfm.mean[y], sfm.variance[y]);
  }
}

}  // namespace rgbd_sfm_fusion
