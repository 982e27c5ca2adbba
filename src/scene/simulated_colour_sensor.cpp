// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/scene/simulated_colour_sensor.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "rgbd_sfm_fusion/multiversion.h"
#include "rgbd_sfm_fusion/scene/random.h"
#include "rgbd_sfm_fusion/tools/number_text.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::uint32_t kNoiseStream = 0x636f, kDriftStream = 0x6472;
constexpr int kBlurSum = 64;  // of the weights (1 6 1) in both directions

void checkRange(const char* name, double value, double low, double high) {
  if (!(value >= low && value <= high)) {
    throw std::invalid_argument(std::string(name) + " is " + numberText(value) + ", expected " +
                                numberText(low) + " to " + numberText(high));
  }
}

/// Weighted sum of three rows.
RGBD_SFM_FUSION_MULTIVERSION
void addRows(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below, int side,
             int centre, int count, std::uint16_t* __restrict sums) {
  for (int i = 0; i < count; ++i) {
    sums[i] = static_cast<std::uint16_t>(side * (above[i] + below[i]) + centre * here[i]);
  }
}

struct Exposure {
  float gain;
  float noise;   ///< per unit of a sum of CounterRandom
  float offset;  ///< includes what makes up for the mean of these sums, and what rounds
};

/// @param sums room for `pairs` pairs
RGBD_SFM_FUSION_MULTIVERSION
void drawNoise(CounterRandom random, std::uint32_t first_counter, int pairs, std::uint16_t* __restrict sums) {
  for (int i = 0; i < pairs; ++i) {
    const std::uint32_t pair = random.twoSums(first_counter + static_cast<std::uint32_t>(i));
    std::memcpy(sums + 2 * i, &pair, sizeof pair);
  }
}

/// Blurs a row of column sums (one RGB pixel of padding on either side), and exposes it.
RGBD_SFM_FUSION_MULTIVERSION
void exposeRow(const std::uint16_t* sums, const std::uint16_t* noise, int side, int centre, Exposure exposure,
               int count, std::uint8_t* __restrict out) {
  for (int i = 0; i < count; ++i) {
    const int sum = side * (sums[i] + sums[i + 6]) + centre * sums[i + 3];
    const float value = exposure.gain * static_cast<float>(sum) +
                        exposure.noise * static_cast<float>(noise[i]) + exposure.offset;
    out[i] = static_cast<std::uint8_t>(static_cast<int>(value < 0.0f     ? 0.0f
                                                        : value > 255.0f ? 255.0f
                                                                         : value));
  }
}

}  // namespace

SimulatedColourSensor::SimulatedColourSensor(const ColourSensorOptions& options, std::uint64_t seed)
    : options_(options), seed_(seed) {
  checkRange("colour.noise", options.noise, 0.0, 50.0);
  checkRange("colour.exposure_drift", options.exposure_drift, 0.0, 0.5);
  checkRange("colour.drift_period", options.drift_period, 0.1, 1e6);
}

double SimulatedColourSensor::gain(double time) const {
  const CounterRandom random(seed_, 0, kDriftStream);
  const double cycles = 2.0 * M_PI * time / options_.drift_period;
  // Two waves whose periods never meet; the exposure begins at 1.
  const double phase = 2.0 * M_PI * static_cast<double>(random.uniform(0));
  const double wave =
      0.6 * std::sin(cycles) + 0.4 * (std::sin(1.618 * cycles + phase) - std::sin(phase)) / 2.0;
  return 1.0 + options_.exposure_drift * wave;
}

void SimulatedColourSensor::expose(const cv::Mat& scene, double time, std::uint32_t frame, cv::Mat& rgb) {
  CV_Assert(scene.type() == CV_8UC3);
  rgb.create(scene.size(), CV_8UC3);
  const int count = 3 * scene.cols, pairs = (count + 1) / 2;
  column_sums_.resize(static_cast<std::size_t>(count) + 6);
  noise_.resize(2 * static_cast<std::size_t>(pairs));
  const int side = options_.blur ? 1 : 0, centre = 8 - 2 * side;
  const auto noise = static_cast<float>(options_.noise) / CounterRandom::kSumSigma;
  const Exposure exposure{static_cast<float>(gain(time) / kBlurSum), noise,
                          0.5f - noise * CounterRandom::kSumMean};
  const CounterRandom random(seed_, frame, kNoiseStream);
  std::uint16_t* sums = column_sums_.data() + 3;
  for (int row = 0; row < scene.rows; ++row) {
    addRows(scene.ptr(std::max(row - 1, 0)), scene.ptr(row), scene.ptr(std::min(row + 1, scene.rows - 1)),
            side, centre, count, sums);
    std::copy_n(sums, 3, sums - 3);
    std::copy_n(sums + count - 3, 3, sums + count);
    drawNoise(random, static_cast<std::uint32_t>(row * pairs), pairs, noise_.data());
    exposeRow(column_sums_.data(), noise_.data(), side, centre, exposure, count, rgb.ptr(row));
  }
}

}  // namespace rgbd_sfm_fusion
