// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/scene/noise.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "rgbd_sfm_fusion/scene/random.h"

namespace rgbd_sfm_fusion {
namespace {

cv::Mat_<float> lattice(cv::Size size, const CounterRandom& random) {
  cv::Mat_<float> values(size);
  std::uint32_t counter = 0;
  for (float& value : values) value = 2.0f * random.uniform(counter++) - 1.0f;
  return values;
}

int cells(int texels, double wavelength) {
  return std::max(2, static_cast<int>(std::lround(2.0 * texels / wavelength)));
}

}  // namespace

cv::Mat_<float> fractalNoise(cv::Size size, const FractalNoise& noise, std::uint32_t seed) {
  cv::Mat_<float> sum(size, 0.0f);
  cv::Mat_<float> octave;
  double amplitude = 1.0, power = 0.0;
  std::uint32_t stream = 0;
  for (double wavelength = noise.longest; wavelength >= 2.0;
       wavelength *= 0.5, amplitude *= noise.persistence) {
    const cv::Size cell_count(cells(size.width, wavelength * noise.stretch), cells(size.height, wavelength));
    cv::resize(lattice(cell_count, CounterRandom(seed, stream++, 0)), octave, size, 0.0, 0.0,
               cv::INTER_CUBIC);
    cv::scaleAdd(octave, amplitude, sum, sum);
    power += amplitude * amplitude;
  }
  if (power > 0.0) sum /= std::sqrt(power);
  return sum;
}

float cellRandom(int x, int y, std::uint32_t seed) {
  return CounterRandom(seed, static_cast<std::uint32_t>(y), 1).uniform(static_cast<std::uint32_t>(x));
}

void addDirt(cv::Mat& rgb, double strength, const FractalNoise& noise, std::uint32_t seed) {
  const cv::Mat_<float> dirt = fractalNoise(rgb.size(), noise, seed);
  for (int row = 0; row < rgb.rows; ++row) {
    const float* factor = dirt[row];
    cv::Vec3b* texel = rgb.ptr<cv::Vec3b>(row);
    for (int x = 0; x < rgb.cols; ++x) {
      const float f = 1.0f + static_cast<float>(strength) * factor[x];
      for (int c = 0; c < 3; ++c)
        texel[x][c] = cv::saturate_cast<std::uint8_t>(f * static_cast<float>(texel[x][c]));
    }
  }
}

}  // namespace rgbd_sfm_fusion
