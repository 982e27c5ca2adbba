// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/depth_resampling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "rgbd_sfm_fusion/input/rectification.h"

namespace rgbd_sfm_fusion {
namespace {

CameraCalibration camera(int width, int height, double f, double cx, double cy) {
  CameraCalibration camera;
  camera.width = width;
  camera.height = height;
  camera.distortion_model = "plumb_bob";
  camera.K = {f, 0, cx, 0, f, cy, 0, 0, 1};
  return camera;
}

const CameraCalibration kColour = camera(64, 48, 52.0, 31.5, 23.5);

/// Depth whose values say where a pixel is.
DepthImage numbered(const CameraCalibration& camera) {
  DepthImage depth(camera.height, camera.width);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) depth(y, x) = static_cast<float>(1000 * y + x);
  }
  return depth;
}

std::string refusalOf(const CameraCalibration& colour, const std::optional<CameraCalibration>& depth,
                      const DepthImage& image) {
  try {
    DepthResampling resampling(colour, depth);
    resampling(image);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(DepthResampling, DepthOfColoursSizeIsAsItIs) {
  const DepthImage depth = numbered(kColour);
  for (const auto& info : {std::optional<CameraCalibration>(),
                           {kColour},
                           {camera(64, 48, 30.0, 20.0, 20.0)},
                           {camera(32, 24, 26.0, 15.5, 11.5)}})
    EXPECT_EQ(DepthResampling(kColour, info)(depth).data, depth.data);
}

TEST(DepthResampling, APartIsPutInItsPlace) {
  const CameraCalibration part = camera(64, 40, 52.0, 31.5, 19.5);  // without four rows above and below
  const DepthImage resampled = DepthResampling(kColour, part)(numbered(part));
  ASSERT_EQ(resampled.size(), cv::Size(64, 48));
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      if (y < 4 || y >= 44) {
        EXPECT_TRUE(std::isnan(resampled(y, x))) << x << " " << y;
      } else {
        EXPECT_EQ(resampled(y, x), static_cast<float>(1000 * (y - 4) + x));
      }
    }
  }
}

TEST(DepthResampling, ScaledDepthKeepsItsPlace) {
  // Centres of pixels: u + 0.5 scales.
  const CameraCalibration half = camera(32, 24, 26.0, 15.5, 11.5), twice = camera(128, 96, 104.0, 63.5, 47.5);
  const DepthImage from_half = DepthResampling(kColour, half)(numbered(half));
  const DepthImage from_twice = DepthResampling(kColour, twice)(numbered(twice));
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      const float value = from_half(y, x);
      const double row = std::floor(static_cast<double>(value) / 1000.0),
                   column = static_cast<double>(value) - 1000.0 * row;
      // Distance between the centres, in colour pixels: there is no nearer centre.
      EXPECT_LE(std::abs(2.0 * column + 0.5 - x), 1.0) << x << " " << y;
      EXPECT_LE(std::abs(2.0 * row + 0.5 - y), 1.0) << x << " " << y;
      const double row2 = std::floor(static_cast<double>(from_twice(y, x)) / 1000.0);
      EXPECT_LE(std::abs(row2 / 2.0 - 0.25 - y), 0.5);
    }
  }
}

TEST(DepthResampling, ScaledAndCutAlongOneSide) {
  // Kinect at 1280x1024, with depth of 640x480: the lowest rows are missing.
  const CameraCalibration colour = camera(128, 102, 105.0, 63.5, 51.0),
                          depth = camera(64, 48, 52.5, 31.5, 25.5);
  EXPECT_EQ(refusalOf(colour, depth, numbered(depth)), "");
}

TEST(DepthResampling, OtherRaysAreRefusedWithBothCameras) {
  // Infrared cameras of a smaller image: another focal length and centre, though within the colour image.
  const CameraCalibration infrared = camera(32, 24, 29.0, 16.0, 12.0);
  const std::string message = refusalOf(kColour, infrared, numbered(infrared));
  EXPECT_NE(message.find("is 32x24, expected 64x48"), std::string::npos) << message;
  EXPECT_NE(message.find("colour 64x48 px, fx = 52"), std::string::npos) << message;
  EXPECT_NE(message.find("depth 32x24 px, fx = 29"), std::string::npos) << message;

  CameraCalibration half = camera(32, 24, 26.0, 15.5, 11.5);
  EXPECT_EQ(refusalOf(kColour, half, numbered(half)), "");
  for (const double shift : {-3.0, 3.0}) {
    CameraCalibration shifted = half;
    shifted.K[2] += shift;
    EXPECT_NE(refusalOf(kColour, shifted, numbered(half)), "") << "beyond the colour image";
  }
  CameraCalibration squeezed = half;
  squeezed.K[4] *= 1.02;
  EXPECT_NE(refusalOf(kColour, squeezed, numbered(half)), "");
  CameraCalibration distorted = half;
  distorted.D = {0.1, 0, 0, 0, 0};
  EXPECT_NE(refusalOf(kColour, distorted, numbered(half)), "");
}

TEST(DepthResampling, WhatIsNotKnownIsNotGuessed) {
  const CameraCalibration half = camera(32, 24, 26.0, 15.5, 11.5);
  EXPECT_NE(refusalOf(kColour, std::nullopt, numbered(half)).find("no camera_info of depth"),
            std::string::npos);
  EXPECT_NE(refusalOf(kColour, kColour, numbered(half)).find("expected 64x48 as in camera_info"),
            std::string::npos);
  EXPECT_NE(refusalOf(kColour, half, numbered(camera(16, 12, 1, 1, 1))).find("16x12, expected 32x24"),
            std::string::npos);
  EXPECT_NE(refusalOf(kColour, camera(32, 24, 0.0, 0.0, 0.0), numbered(half)).find("K[0] is 0"),
            std::string::npos);
}

TEST(Rectifier, TakesDepthOfAnotherSize) {
  CameraCalibration half = camera(32, 24, 26.0, 15.5, 11.5), colour = kColour;
  colour.D = half.D = {0.1, 0, 0, 0, 0};
  const Rectifier rectifier(colour, half);
  EXPECT_EQ(rectifier.rectify(numbered(half)).size(), cv::Size(64, 48));
}

}  // namespace
}  // namespace rgbd_sfm_fusion
