// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/scene/simulated_depth_sensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

namespace rgbd_sfm_fusion {
namespace {

constexpr double kFx = 525.0;

/// What a camera sees of a wall whose depth goes from `near` to `far` [m] down the image.
GeometryBuffer wall(double near, double far) {
  GeometryBuffer geometry;
  geometry.inverse_depth.create(480, 640);
  geometry.surface = cv::Mat_<std::int32_t>(480, 640, 0);
  geometry.patch_count = 1;
  geometry.surfaces.resize(2);
  for (int row = 0; row < 480; ++row) {
    geometry.inverse_depth.row(row).setTo(1.0 / (near + (far - near) * row / 479.0));
  }
  return geometry;
}

double truth(const GeometryBuffer& geometry, int row) {
  return 1.0 / static_cast<double>(geometry.inverse_depth(row, 0));
}

std::vector<Patch> onePatch(Material material = Material::kMatte) {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, material}};
}

cv::Mat measured(const GeometryBuffer& geometry, const DepthSensorOptions& options = {},
                 Material material = Material::kMatte) {
  cv::Mat depth;
  SimulatedDepthSensor(options, 3).measure(geometry, onePatch(material), kFx, 0, depth);
  return depth;
}

TEST(SimulatedDepthSensor, NoiseFollowsTheLawWithStepsIncludedOnce) {
  DepthSensorOptions options;
  options.max_range = 6.0;  // so that it does not cut the tail at 5 m
  options.scale_sigma = 0.0;
  for (const double distance : {1.0, 1.5, 2.0, 3.0, 4.0, 5.0}) {
    // Sloped by 4 %, so that true depths lie all over the steps between two measurable ones.
    const GeometryBuffer geometry = wall(0.98 * distance, 1.02 * distance);
    const cv::Mat depth = measured(geometry, options);
    double squares = 0.0, sum = 0.0, products = 0.0, last = 0.0;
    int count = 0;
    for (int row = 0; row < depth.rows; ++row) {
      const double z = truth(geometry, row), sigma = 1.425e-3 * z * z;
      for (int x = 0; x < depth.cols; ++x, ++count) {
        const double error = (1e-3 * depth.at<std::uint16_t>(row, x) - z) / sigma;
        squares += error * error;
        products += error * last;
        sum += error;
        last = error;
      }
    }
    EXPECT_NEAR(std::sqrt(squares / count), 1.0, 0.05) << distance;
    RecordProperty("sigma_ratio_at_" + std::to_string(static_cast<int>(1000 * distance)) + "_mm",
                   std::to_string(std::sqrt(squares / count)));
    EXPECT_NEAR(sum / count, 0.0, 0.05) << distance;
    EXPECT_NEAR(products / count, 0.0, 0.05) << distance << ", of neighbours";
  }
}

TEST(SimulatedDepthSensor, EveryDeviceHasAScaleOfItsOwn) {
  const GeometryBuffer geometry = wall(1.9, 2.1);
  for (const std::uint64_t seed : {1U, 2U, 77U}) {
    cv::Mat depth;
    SimulatedDepthSensor({}, seed).measure(geometry, onePatch(), kFx, 0, depth);
    EXPECT_NEAR(cv::mean(depth)[0] / 2000.0, depthScale(0.005, seed), 2e-4);
  }
}

TEST(SimulatedDepthSensor, AnyFiveSeedsHaveScalesAllOverTheGaussian) {
  for (std::uint64_t first = 0; first < 200; ++first) {
    std::array<double, 5> z;
    for (std::size_t i = 0; i < z.size(); ++i) z[i] = depthScale(1.0, first + i) - 1.0;
    std::sort(z.begin(), z.end());
    EXPECT_LT(z[0], -0.55) << first;
    EXPECT_GT(z[4], 0.55) << first;
    EXPECT_LT(std::abs(z[2]), 0.55) << first;
    EXPECT_LT(std::abs(z[4]), 4.0) << first;
  }
  EXPECT_EQ(depthScale(0.0, 5), 1.0);
}

TEST(SimulatedDepthSensor, WithoutNoiseOnlyMillimetresAreRounded) {
  DepthSensorOptions options;
  options.noise = false;
  const GeometryBuffer geometry = wall(0.7, 4.9);
  const cv::Mat depth = measured(geometry, options);
  for (int row = 0; row < depth.rows; ++row) {
    EXPECT_NEAR(1e-3 * depth.at<std::uint16_t>(row, 300), truth(geometry, row), 5.01e-4);
  }
}

TEST(SimulatedDepthSensor, SeesNothingOutOfRange) {
  for (const bool noise : {true, false}) {
    DepthSensorOptions options;
    options.noise = noise;
    for (const double distance : {0.01, 0.55, 5.6, 60.0, 1e9}) {
      EXPECT_EQ(cv::countNonZero(measured(wall(distance, distance), options)), 0) << distance;
    }
    GeometryBuffer nothing = wall(1.0, 1.0);
    nothing.inverse_depth.setTo(0.0);
    nothing.surface.setTo(GeometryBuffer::kNothing);
    EXPECT_EQ(cv::countNonZero(measured(nothing, options)), 0);
  }
}

TEST(SimulatedDepthSensor, SeesMatteSurfacesOnly) {
  EXPECT_EQ(cv::countNonZero(measured(wall(2.0, 2.0))), 640 * 480);
  for (const Material material : {Material::kDark, Material::kShiny, Material::kSunlit, Material::kMirror}) {
    EXPECT_EQ(cv::countNonZero(measured(wall(2.0, 2.0), {}, material)), 0);
    DepthSensorOptions options;
    options.materials = false;
    EXPECT_EQ(cv::countNonZero(measured(wall(2.0, 2.0), options, material)), 640 * 480);
  }
}

TEST(SimulatedDepthSensor, ThingsCastShadowsToTheirRight) {
  GeometryBuffer geometry = wall(4.0, 4.0);
  geometry.inverse_depth.colRange(200, 300).setTo(1.0);  // a board 1 m away
  const cv::Mat depth = measured(geometry);
  const int shadow =
      static_cast<int>(std::lround(kFx * DepthSensorOptions{}.baseline * (1.0 / 1.0 - 1.0 / 4.0)));
  for (int row = 0; row < depth.rows; row += 37) {
    for (int x = 0; x < depth.cols; ++x) {
      if (std::abs(x - 300) <= 1 || std::abs(x - 300 - shadow) <= 1) continue;
      EXPECT_EQ(depth.at<std::uint16_t>(row, x) == 0, x > 300 && x < 300 + shadow) << x;
    }
  }
}

TEST(SimulatedDepthSensor, LightPassesBetweenAThinThingAndItsShadow) {
  GeometryBuffer geometry = wall(4.0, 4.0);
  geometry.inverse_depth.colRange(300, 306).setTo(1.0);
  const cv::Mat depth = measured(geometry);
  EXPECT_GT(depth.at<std::uint16_t>(100, 315), 0);  // its shadow is at 330 to 336
  EXPECT_EQ(depth.at<std::uint16_t>(100, 332), 0);
  EXPECT_GT(depth.at<std::uint16_t>(100, 345), 0);
}

TEST(SimulatedDepthSensor, RefusesNonsense) {
  const auto refused = [](auto change) {
    DepthSensorOptions options;
    change(options);
    EXPECT_THROW(SimulatedDepthSensor(options, 1), std::invalid_argument);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused([&](DepthSensorOptions& o) { o.step = 0.0; });
  refused([&](DepthSensorOptions& o) { o.step = nan; });
  refused([&](DepthSensorOptions& o) { o.sigma = -1.0; });
  refused([&](DepthSensorOptions& o) { o.baseline = nan; });
  refused([&](DepthSensorOptions& o) { o.scale_sigma = nan; });
  refused([&](DepthSensorOptions& o) { o.min_range = 0.0; });
  refused([&](DepthSensorOptions& o) { o.max_range = o.min_range; });
  refused([&](DepthSensorOptions& o) { o.max_range = 70.0; });
}

}  // namespace
}  // namespace rgbd_sfm_fusion
