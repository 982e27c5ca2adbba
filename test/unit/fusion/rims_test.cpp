// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/sfm_only.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace rgbd_sfm_fusion {
namespace {

/// Sensor depth in three places, two of them at the image's border.
class Rims : public testing::Test {
 protected:
  Rims() {
    for (const cv::Point& pixel : {cv::Point(20, 15), cv::Point(0, 29), cv::Point(39, 2)})
      measured_(pixel) = 1;
  }

  bool isNear(const cv::Mat& mask, int x, int y, int width) const {
    const cv::Rect square(x - width, y - width, 2 * width + 1, 2 * width + 1);
    return cv::countNonZero(mask(square & cv::Rect({0, 0}, mask.size()))) > 0;
  }

  cv::Mat_<std::uint8_t> measured_ = cv::Mat_<std::uint8_t>(30, 40, std::uint8_t{0});
};

TEST_F(Rims, AreHolesNearWhatTheSensorSees) {
  for (const int width : {1, 3, 20}) {
    cv::Mat_<std::uint8_t> marked(measured_.size(), std::uint8_t{0});
    markRims(measured_, width, marked);
    for (int y = 0; y < 30; ++y) {
      for (int x = 0; x < 40; ++x) {
        const bool is_rim = isNear(measured_, x, y, width) && measured_(y, x) == 0;
        EXPECT_EQ(marked(y, x) != 0, is_rim) << "at " << x << ", " << y << ", width " << width;
      }
    }
  }
}

TEST_F(Rims, OfNoWidthDoNothing) {
  cv::Mat_<std::uint8_t> marked(measured_.size(), std::uint8_t{0});
  markRims(measured_, 0, marked);
  EXPECT_EQ(cv::countNonZero(marked), 0);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
