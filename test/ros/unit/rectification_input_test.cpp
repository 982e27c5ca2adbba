// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/rectification_input.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace rgbd_sfm_fusion {
namespace {

/// A raw camera with a lens, and with another focal length after rectification.
sensor_msgs::CameraInfo cameraWithLens() {
  sensor_msgs::CameraInfo info;
  info.width = 64;
  info.height = 48;
  info.distortion_model = "plumb_bob";
  info.D = {-0.3, 0.1, 0.0, 0.0, 0.0};
  info.K = {60.0, 0.0, 31.5, 0.0, 60.0, 23.5, 0.0, 0.0, 1.0};
  info.P = {55.0, 0.0, 31.5, 0.0, 0.0, 55.0, 23.5, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

DepthImage slope() {
  DepthImage depth(48, 64);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) depth(y, x) = 1.0F + 0.01F * static_cast<float>(x + y);
  }
  return depth;
}

bool isSame(const DepthImage& a, const DepthImage& b) {
  return a.size() == b.size() && cv::countNonZero(a != b) == 0;
}

TEST(RectificationInput, DepthThatIsRectifiedByItsNameIsNotRectifiedAgain) {
  const DepthImage depth = slope();
  for (const bool is_rectified : {false, true}) {
    RectificationInput input;
    input.setTopics("/camera/rgb/image_raw", is_rectified
                                                 ? "/camera/depth_registered/sw_registered/image_rect"
                                                 : "/camera/depth/image_raw");
    ASSERT_TRUE(input.update(cameraWithLens()));
    EXPECT_EQ(isSame(input.rectifier()->rectify(depth), depth), is_rectified);
    EXPECT_FALSE(input.colourIsRectified());
  }
}

TEST(RectificationInput, RectifiedDepthMayHaveTheCameraInfoOfRawColour) {
  RectificationInput input;
  input.setTopics("/camera/rgb/image_raw", "/camera/depth_registered/sw_registered/image_rect");
  input.updateDepth(cameraWithLens());
  EXPECT_FALSE(input.differenceOfDepth()) << "colour's is not known yet";
  ASSERT_TRUE(input.update(cameraWithLens()));
  EXPECT_FALSE(input.differenceOfDepth()) << *input.differenceOfDepth();
}

TEST(RectificationInput, RectifiedDepthMayBeOfAnotherSize) {
  RectificationInput input;
  input.setTopics("/camera/rgb/image_raw", "/camera/depth_registered/sw_registered/image_rect");
  sensor_msgs::CameraInfo half = cameraWithLens();
  half.width /= 2;
  half.height /= 2;
  for (const std::size_t i : {0U, 4U}) half.K[i] /= 2.0;
  for (const std::size_t i : {0U, 5U}) half.P[i] /= 2.0;
  for (const std::size_t i : {2U, 5U}) half.K[i] = 0.5 * (half.K[i] + 0.5) - 0.5;
  for (const std::size_t i : {2U, 6U}) half.P[i] = 0.5 * (half.P[i] + 0.5) - 0.5;
  input.updateDepth(half);
  ASSERT_TRUE(input.update(cameraWithLens()));
  EXPECT_EQ(input.rectifier()->rectify(DepthImage(24, 32, 2.0F)).size(), cv::Size(64, 48));
}

}  // namespace
}  // namespace rgbd_sfm_fusion
