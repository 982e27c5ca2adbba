// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/rims.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rgbd_sfm_fusion {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// Sensor depth in three places, two of them at the image's border; SfM depth everywhere.
class Rims : public testing::Test {
 protected:
  Rims() {
    for (const cv::Point& pixel : {cv::Point(20, 15), cv::Point(0, 29), cv::Point(39, 2)})
      sensor_(pixel) = 2.0f;
  }

  bool isNearSensorDepth(int x, int y, int width) const {
    const cv::Rect square(x - width, y - width, 2 * width + 1, 2 * width + 1);
    const cv::Mat_<float> around = sensor_(square & cv::Rect({0, 0}, sensor_.size()));
    return cv::countNonZero(around > 0.0) > 0;
  }

  DepthImage sensor_ = DepthImage(30, 40, kNaN);
  GaussianDepth sfm_{DepthImage(30, 40, 2.1f), cv::Mat_<float>(30, 40, 0.01f)};
};

TEST_F(Rims, DepthIsDroppedNearWhatTheSensorSees) {
  for (const int width : {1, 3, 20}) {
    GaussianDepth sfm{sfm_.mean.clone(), sfm_.variance.clone()};
    dropAtRims(sensor_, width, sfm);
    for (int y = 0; y < sensor_.rows; ++y) {
      for (int x = 0; x < sensor_.cols; ++x) {
        const bool dropped = isNearSensorDepth(x, y, width) && !(sensor_(y, x) > 0.0f);
        EXPECT_EQ(std::isnan(sfm.mean(y, x)), dropped) << "at " << x << ", " << y << ", width " << width;
        EXPECT_EQ(std::isnan(sfm.variance(y, x)), dropped) << "at " << x << ", " << y << ", width " << width;
      }
    }
  }
}

TEST_F(Rims, OfNoWidthDropNothing) {
  dropAtRims(sensor_, 0, sfm_);
  EXPECT_EQ(cv::countNonZero(sfm_.mean == 2.1f), 30 * 40);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
