// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/scene/simulated_depth_sensor.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "rgbd_sfm_fusion/scene/random.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::uint32_t kNoiseStream = 0x6465;

// A surface that is nearer by less than this share is taken for the same one, and casts no shadow on it.
constexpr float kSameSurface = 1.03f;

void require(bool good, const std::string& what) {
  if (!good) throw std::invalid_argument(what);
}

/// @param sigma [1/m]; with 0 there is neither noise nor rounding to steps
struct RowNoise {
  float sigma;
  float step;
};

/// Adds noise to inverse depth, rounds it to whole steps, and turns it into millimetres.
void measureRow(const float* inverse_depth, const std::uint8_t* lit, const RowNoise& noise, float near_limit,
                float far_limit, const CounterRandom& random, std::uint32_t first_counter, int count,
                std::uint16_t* millimetres) {
  // Two sums of four bytes make a Gaussian up to 4.9 sigma.
  const float per_unit = noise.sigma / (CounterRandom::kByteSumSigma * 1.41421356f * noise.step);
  for (int i = 0; i < count; ++i) {
    const std::uint32_t counter = first_counter + 2U * static_cast<std::uint32_t>(i);
    const int units = random.byteSum(counter) + random.byteSum(counter + 1U);
    const float steps = inverse_depth[i] / noise.step + per_unit * static_cast<float>(units);
    const float measured = noise.step * static_cast<float>(static_cast<int>(steps + 0.5f));
    const bool valid = (lit[i] != 0) & (measured >= far_limit) & (measured <= near_limit);
    const float depth = 1000.0f / std::max(measured, 1e-3f) + 0.5f;
    millimetres[i] = static_cast<std::uint16_t>(valid ? static_cast<int>(depth) : 0);
  }
}

void convertRow(const float* inverse_depth, const std::uint8_t* lit, float near_limit, float far_limit,
                int count, std::uint16_t* millimetres) {
  for (int i = 0; i < count; ++i) {
    const bool valid = (lit[i] != 0) & (inverse_depth[i] >= far_limit) & (inverse_depth[i] <= near_limit);
    const float depth = 1000.0f / std::max(inverse_depth[i], 1e-3f) + 0.5f;
    millimetres[i] = static_cast<std::uint16_t>(valid ? static_cast<int>(depth) : 0);
  }
}

}  // namespace

SimulatedDepthSensor::SimulatedDepthSensor(const DepthSensorOptions& options, std::uint64_t seed)
    : options_(options), seed_(seed) {
  require(options.step >= 1e-5 && options.step <= 0.1, "depth.step has to be 1e-5 to 0.1 per metre");
  require(options.sigma >= 0.0 && options.sigma <= 100.0, "depth.sigma has to be 0 to 100 steps");
  require(options.baseline >= 0.0 && options.baseline <= 1.0, "depth.baseline has to be 0 to 1 m");
  require(options.min_range >= 0.1 && options.min_range < options.max_range && options.max_range <= 65.0,
          "depth.min_range and max_range have to be 0.1 m <= min_range < max_range <= 65 m");
}

void SimulatedDepthSensor::findShadow(const float* inverse_depth, int width, float disparity_scale,
                                      std::uint8_t* lit) {
  const int columns = static_cast<int>(projector_.size());
  // The light that falls on pixel x left the projector in this column; nearer is further to the right.
  const auto column = [&](int x) {
    const int c = x + static_cast<int>(disparity_scale * inverse_depth[x] + 0.5f);
    return std::min(c, columns - 2);
  };
  std::fill(projector_.begin(), projector_.end(), 0.0f);
  for (int x = 0; x < width; ++x) {
    // Two columns, as surfaces that face the projector more than the camera are wider there.
    float* c = &projector_[static_cast<std::size_t>(column(x))];
    c[0] = std::max(c[0], inverse_depth[x]);
    c[1] = std::max(c[1], inverse_depth[x]);
  }
  for (int x = 0; x < width; ++x) {
    if (projector_[static_cast<std::size_t>(column(x))] > kSameSurface * inverse_depth[x]) lit[x] = 0;
  }
}

void SimulatedDepthSensor::measure(const GeometryBuffer& geometry, const std::vector<Patch>& patches,
                                   double fx, std::uint32_t frame, cv::Mat& depth) {
  const int width = geometry.surface.cols;
  depth.create(geometry.surface.size(), CV_16UC1);
  lit_.resize(static_cast<std::size_t>(width));
  // Wide enough for all that is not far too near for the sensor anyway.
  projector_.resize(static_cast<std::size_t>(width + static_cast<int>(10.0 * fx * options_.baseline) + 2));
  seen_.assign(geometry.surfaces.size(), 1);
  for (std::size_t i = 0; options_.materials && i < seen_.size(); ++i) {
    const bool mirrored = geometry.mirrored(static_cast<std::int32_t>(i));
    seen_[i] = !mirrored && patches[i].material == Material::kMatte;
  }
  const CounterRandom random(seed_, frame, kNoiseStream);
  const RowNoise noise{static_cast<float>(options_.sigma * options_.step), static_cast<float>(options_.step)};
  const auto near_limit = static_cast<float>(1.0 / options_.min_range);
  const auto far_limit = static_cast<float>(1.0 / options_.max_range);
  for (int row = 0; row < geometry.surface.rows; ++row) {
    const std::int32_t* surface = geometry.surface[row];
    const float* inverse_depth = geometry.inverse_depth[row];
    for (int x = 0; x < width; ++x) {
      lit_[static_cast<std::size_t>(x)] = surface[x] < 0 ? 0 : seen_[static_cast<std::size_t>(surface[x])];
    }
    if (options_.shadow)
      findShadow(inverse_depth, width, static_cast<float>(fx * options_.baseline), lit_.data());
    auto* out = depth.ptr<std::uint16_t>(row);
    if (options_.noise) {
      measureRow(inverse_depth, lit_.data(), noise, near_limit, far_limit, random,
                 static_cast<std::uint32_t>(2 * row * width), width, out);
    } else {
      convertRow(inverse_depth, lit_.data(), near_limit, far_limit, width, out);
    }
  }
}

}  // namespace rgbd_sfm_fusion
