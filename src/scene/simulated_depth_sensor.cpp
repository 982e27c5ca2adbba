// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/scene/simulated_depth_sensor.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "rgbd_sfm_fusion/multiversion.h"
#include "rgbd_sfm_fusion/scene/random.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::uint32_t kNoiseStream = 0x6465;

// A surface whose depth is within this factor is taken for the same surface, and casts no shadow on it.
constexpr float kSameSurface = 1.03f;

void require(bool good, const std::string& what) {
  if (!good) throw std::invalid_argument(what);
}

/// Noise and limits, in steps of inverse depth.
struct StepNoise {
  float steps_per_inverse_metre;
  float sigma_per_unit;  ///< of both of twoSums()
  float millimetres;     ///< [step * mm] depth at one step
  int fewest;            ///< steps of the farthest depth
  int most;              ///< steps of the nearest depth
};

/// @param scale of measured depth to true depth
StepNoise stepNoise(const DepthSensorOptions& options, double scale) {
  StepNoise noise;
  noise.steps_per_inverse_metre = static_cast<float>(1.0 / (options.step * scale));
  noise.sigma_per_unit = static_cast<float>(options.sigma / std::sqrt(2.0)) / CounterRandom::kSumSigma;
  noise.millimetres = static_cast<float>(1000.0 / options.step);
  noise.fewest = std::max(1, static_cast<int>(std::ceil(1.0 / (options.max_range * options.step))));
  noise.most = static_cast<int>(std::floor(1.0 / (options.min_range * options.step)));
  return noise;
}

/// Adds noise to inverse depth, rounds it to whole steps, and turns it into millimetres.
/// @param lit 1 where light comes back, 0 elsewhere
RGBD_SFM_FUSION_MULTIVERSION
void measureRow(const float* inverse_depth, const std::uint8_t* lit, StepNoise noise, CounterRandom random,
                std::uint32_t first_counter, int count, std::uint16_t* __restrict millimetres) {
  for (int i = 0; i < count; ++i) {
    // Both sums together make a Gaussian up to 4.6 sigma.
    const std::uint32_t sums = random.twoSums(first_counter + static_cast<std::uint32_t>(i));
    const int units = static_cast<int>((sums & 0xffffU) + (sums >> 16)) - 2 * CounterRandom::kSumMean;
    const float noisy =
        inverse_depth[i] * noise.steps_per_inverse_metre + noise.sigma_per_unit * static_cast<float>(units);
    const int steps = static_cast<int>(noisy + 0.5f);
    const int valid = lit[i] & (steps >= noise.fewest) & (steps <= noise.most);
    const int depth = static_cast<int>(noise.millimetres / static_cast<float>(std::max(steps, 1)) + 0.5f);
    millimetres[i] = static_cast<std::uint16_t>(valid * depth);
  }
}

/// @param seen by surface: 1 where the sensor sees it
void markSeen(const std::int32_t* surface, const std::uint8_t* seen, int width,
              std::uint8_t* __restrict lit) {
  for (int x = 0; x < width; ++x) lit[x] = surface[x] < 0 ? 0 : seen[surface[x]];
}

/// The projector's column, counted from 1, from which the light on pixel x came. For nearer things it is
/// further right.
RGBD_SFM_FUSION_MULTIVERSION
void findColumns(const float* inverse_depth, int width, float disparity_scale, int last,
                 int* __restrict columns) {
  for (int x = 0; x < width; ++x) {
    columns[x] = std::min(x + 1 + static_cast<int>(disparity_scale * inverse_depth[x] + 0.5f), last);
  }
}

void convertRow(const float* inverse_depth, const std::uint8_t* lit, const DepthSensorOptions& options,
                int count, std::uint16_t* millimetres) {
  for (int i = 0; i < count; ++i) {
    const float depth = 1.0f / inverse_depth[i];
    const bool valid = lit[i] != 0 && depth >= static_cast<float>(options.min_range) &&
                       depth <= static_cast<float>(options.max_range);
    millimetres[i] = static_cast<std::uint16_t>(valid ? 1000.0f * depth + 0.5f : 0.0f);
  }
}

/// Where the standard normal distribution reaches `probability`.
double gaussianQuantile(double probability) {
  double low = -10.0, high = 10.0;
  while (high - low > 1e-12) {
    const double middle = 0.5 * (low + high);
    (0.5 * std::erfc(-middle / std::sqrt(2.0)) < probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

double depthScale(double scale_sigma, std::uint64_t seed) {
  constexpr double kGoldenRatio = 0.6180339887498949;
  // Multiples of the golden ratio leave no large gap in the unit interval, however many are taken.
  const double turns = 0.5 + kGoldenRatio * static_cast<double>(seed % 1000003U);
  return 1.0 + scale_sigma * gaussianQuantile(turns - std::floor(turns));
}

SimulatedDepthSensor::SimulatedDepthSensor(const DepthSensorOptions& options, std::uint64_t seed)
    : options_(options), seed_(seed), scale_(depthScale(options.scale_sigma, seed)) {
  require(options.step >= 1e-5 && options.step <= 0.1, "depth.step has to be 1e-5 to 0.1 per metre");
  require(options.sigma >= 0.0 && options.sigma <= 100.0, "depth.sigma has to be 0 to 100 steps");
  require(options.scale_sigma >= 0.0 && options.scale_sigma <= 0.05, "depth.scale_sigma has to be 0 to 0.05");
  require(options.baseline >= 0.0 && options.baseline <= 1.0, "depth.baseline has to be 0 to 1 m");
  require(options.min_range >= 0.1 && options.min_range < options.max_range && options.max_range <= 65.0,
          "depth.min_range and max_range have to be 0.1 m <= min_range < max_range <= 65 m");
}

void SimulatedDepthSensor::findShadow(const float* inverse_depth, int width, float disparity_scale,
                                      std::uint8_t* __restrict lit) {
  findColumns(inverse_depth, width, disparity_scale, static_cast<int>(projector_.size()) - 1,
              columns_.data());
  std::fill(projector_.begin(), projector_.end(), 0.0f);
  const int* columns = columns_.data();
  float* projector = projector_.data();
  for (int x = 0; x < width; ++x) {
    projector[columns[x]] = std::max(projector[columns[x]], inverse_depth[x]);
  }
  for (int x = 0; x < width; ++x) {
    // Two columns, as surfaces that face the projector more than the camera are wider there.
    const float nearest = std::max(projector[columns[x] - 1], projector[columns[x]]);
    lit[x] = lit[x] & static_cast<std::uint8_t>(nearest <= kSameSurface * inverse_depth[x]);
  }
}

void SimulatedDepthSensor::measure(const GeometryBuffer& geometry, const std::vector<Patch>& patches,
                                   double fx, std::uint32_t frame, cv::Mat& depth) {
  const int width = geometry.surface.cols;
  depth.create(geometry.surface.size(), CV_16UC1);
  lit_.resize(static_cast<std::size_t>(width));
  columns_.resize(static_cast<std::size_t>(width));
  // Wide enough for everything but surfaces that are far too near for the sensor anyway.
  projector_.resize(static_cast<std::size_t>(width + static_cast<int>(10.0 * fx * options_.baseline) + 2));
  seen_.assign(geometry.surfaces.size(), 1);
  for (std::size_t i = 0; options_.materials && i < seen_.size(); ++i) {
    const bool mirrored = geometry.mirrored(static_cast<std::int32_t>(i));
    seen_[i] = !mirrored && patches[i].material == Material::kMatte;
  }
  const CounterRandom random(seed_, frame, kNoiseStream);
  const StepNoise noise = stepNoise(options_, scale_);
  for (int row = 0; row < geometry.surface.rows; ++row) {
    const std::int32_t* surface = geometry.surface[row];
    const float* inverse_depth = geometry.inverse_depth[row];
    markSeen(surface, seen_.data(), width, lit_.data());
    if (options_.shadow)
      findShadow(inverse_depth, width, static_cast<float>(fx * options_.baseline), lit_.data());
    auto* out = depth.ptr<std::uint16_t>(row);
    if (options_.noise) {
      measureRow(inverse_depth, lit_.data(), noise, random, static_cast<std::uint32_t>(row * width), width,
                 out);
    } else {
      convertRow(inverse_depth, lit_.data(), options_, width, out);
    }
  }
}

}  // namespace rgbd_sfm_fusion
