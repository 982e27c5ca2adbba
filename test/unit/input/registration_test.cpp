// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/registration.h"

#include <gtest/gtest.h>

namespace rgbd_sfm_fusion {
namespace {

TEST(Registration, IsDoubtedWhereDepthIsInAnotherFrame) {
  const std::string doubt = doubtOfRegistration("camera_rgb_optical_frame", "camera_depth_optical_frame");
  for (const char* part : {"camera_rgb_optical_frame", "camera_depth_optical_frame", "depth_registration"})
    EXPECT_NE(doubt.find(part), std::string::npos) << doubt;
  EXPECT_EQ(doubtOfRegistration("camera_rgb_optical_frame", "camera_rgb_optical_frame"), "");
  EXPECT_EQ(doubtOfRegistration("", "camera_depth_optical_frame"), "") << "nothing is known";
  EXPECT_EQ(doubtOfRegistration("camera_rgb_optical_frame", ""), "");
}

}  // namespace
}  // namespace rgbd_sfm_fusion
