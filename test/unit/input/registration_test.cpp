// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/registration.h"

#include <gtest/gtest.h>

#include <limits>
#include <opencv2/imgproc.hpp>

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

/// Boxes in front of a textured wall, of another brightness and depth, at other places in each image.
class RegistrationWatchTest : public testing::Test {
 protected:
  /// @param offset [px] of depth to the right; @param shadow [px] without depth at the right of each box
  std::string doubtAfter(int frames, int offset, int shadow = 0, double contrast = 60.0) {
    RegistrationWatch watch;
    cv::RNG random(5);
    for (int i = 0; i < frames; ++i) {
      GreyImage grey(240, 320);
      random.fill(grey, cv::RNG::UNIFORM, 90, 130);
      cv::blur(grey, grey, {3, 3});
      DepthImage depth(240, 320, 3.0F);
      for (int box = 0; box < 4; ++box) {
        const cv::Rect place(40 + 70 * box + random.uniform(-15, 15), random.uniform(20, 80), 30, 120);
        grey(place) += contrast;
        depth(place + cv::Point(offset, 0)) = 1.2F;
        const cv::Rect beside(place.br().x + offset, place.y, shadow, place.height);
        depth(beside & cv::Rect({}, depth.size())) = std::numeric_limits<float>::quiet_NaN();
      }
      watch.add(grey, depth);
    }
    return watch.doubt();
  }
};

TEST_F(RegistrationWatchTest, EdgesThatMeetAreNotDoubted) {
  for (const int offset : {0, 3, -4}) EXPECT_EQ(doubtAfter(120, offset), "") << offset;
  EXPECT_EQ(doubtAfter(120, 0, 9), "") << "with the shadow of an infrared projector";
}

TEST_F(RegistrationWatchTest, EdgesThatLieBesideAreSaidWithTheirDistance) {
  for (const int shadow : {0, 9}) {
    const std::string right = doubtAfter(120, 12, shadow), left = doubtAfter(120, -10, shadow);
    EXPECT_NE(right.find("12 px right"), std::string::npos) << right;
    EXPECT_NE(left.find("10 px left"), std::string::npos) << left;
    EXPECT_NE(left.find("register_depth:=true"), std::string::npos) << left;
  }
}

TEST_F(RegistrationWatchTest, NothingIsSaidOfFewImagesOrOfImagesWithoutEdges) {
  EXPECT_EQ(doubtAfter(20, 12), "");
  EXPECT_EQ(doubtAfter(120, 12, 0, 0.0), "");
  RegistrationWatch watch;
  for (int i = 0; i < 120; ++i) {
    watch.add(GreyImage(240, 320, std::uint8_t{0}), DepthImage());
    watch.add(GreyImage(240, 320, std::uint8_t{0}), DepthImage(240, 320, 1.0F));
  }
  EXPECT_EQ(watch.doubt(), "");
}

}  // namespace
}  // namespace rgbd_sfm_fusion
