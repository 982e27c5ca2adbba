// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/shared_preparation.h"

#include <gtest/gtest.h>

#include "fake_camera.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kUnit = 0.001;

std::shared_ptr<const Rectifier> rectifierOf(const FakeCamera& camera) {
  return sharedRectifier(toCalibration(camera.info(0)), std::nullopt, false);
}

TEST(SharedPreparation, TheSameCalibrationIsTheSameRectifier) {
  const FakeCamera camera;
  const auto rectifier = rectifierOf(camera);
  EXPECT_EQ(rectifierOf(camera), rectifier);
  EXPECT_NE(rectifierOf(FakeCamera({64, 48, 50.0, 50.0, 31.5, 23.5})), rectifier);
  const CameraCalibration calibration = toCalibration(camera.info(0));
  EXPECT_NE(sharedRectifier(calibration, std::nullopt, true), rectifier);
  EXPECT_NE(sharedRectifier(calibration, calibration, false), rectifier);
}

TEST(SharedPreparation, AMessageIsPreparedOnce) {
  const FakeCamera camera;
  const auto rectifier = rectifierOf(camera);
  const sensor_msgs::ImageConstPtr colour = camera.colour(0), depth = camera.depthImage(0);
  const GreyImage grey = sharedGrey(colour, rectifier);
  const DepthImage metres = sharedDepth(depth, rectifier, kUnit, 0.0);
  EXPECT_NEAR(metres(120, 160), camera.depth(0, 160), 1e-3F);
  EXPECT_EQ(sharedGrey(colour, rectifier).data, grey.data);
  EXPECT_EQ(sharedDepth(depth, rectifier, kUnit, 0.0).data, metres.data);
}

TEST(SharedPreparation, AnotherMessageUnitOrRectifierIsPreparedAnew) {
  const FakeCamera camera;
  const auto rectifier = rectifierOf(camera);
  const sensor_msgs::ImageConstPtr depth = camera.depthImage(0);
  const DepthImage metres = sharedDepth(depth, rectifier, kUnit, 0.0);
  const DepthImage doubled = sharedDepth(depth, rectifier, 2.0 * kUnit, 0.0);
  EXPECT_FLOAT_EQ(doubled(120, 160), 2.0F * metres(120, 160));
  const auto saturated = static_cast<double>(metres(120, 160));
  EXPECT_FALSE(sharedDepth(depth, rectifier, kUnit, saturated)(120, 160) > 0.0F);
  const auto another = sharedRectifier(toCalibration(camera.info(0)), std::nullopt, true);
  EXPECT_NE(sharedDepth(depth, another, kUnit, 0.0).data, metres.data);
  EXPECT_NE(sharedDepth(camera.depthImage(0), rectifier, kUnit, 0.0).data, metres.data);
}

/// The next message may lie where the last one lay.
TEST(SharedPreparation, WhatWasMadeOfAMessageGoesWithIt) {
  const FakeCamera camera;
  const auto rectifier = rectifierOf(camera);
  for (int frame = 0; frame < 20; ++frame) {
    const sensor_msgs::ImageConstPtr depth = camera.depthImage(10 * frame);
    EXPECT_NEAR(sharedDepth(depth, rectifier, kUnit, 0.0)(120, 160), camera.depth(10 * frame, 160), 1e-3F);
  }
}

TEST(SharedPreparation, NoImageIsNoDepth) {
  EXPECT_TRUE(sharedDepth(nullptr, rectifierOf(FakeCamera()), kUnit, 0.0).empty());
}

}  // namespace
}  // namespace rgbd_sfm_fusion
