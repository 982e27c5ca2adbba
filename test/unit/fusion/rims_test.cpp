// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/sfm_only.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rgbd_sfm_fusion {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr double kVariance = 1e-4;

/// Sensor depth in three places, two of them at the image's border; SfM depth everywhere.
class Rims : public testing::Test {
 protected:
  Rims() {
    for (const cv::Point& pixel : {cv::Point(20, 15), cv::Point(0, 29), cv::Point(39, 2)})
      setSensor(cv::Rect(pixel, cv::Size(1, 1)), kVariance);
  }

  /// @param variance  NaN: a hole
  void setSensor(const cv::Rect& pixels, double variance) {
    sensor_.mean(pixels).setTo(std::isnan(variance) ? variance : 2.0);
    sensor_.variance(pixels).setTo(variance);
  }

  bool isNear(const cv::Mat& mask, int x, int y, int width) const {
    const cv::Rect square(x - width, y - width, 2 * width + 1, 2 * width + 1);
    return cv::countNonZero(mask(square & cv::Rect({0, 0}, mask.size()))) > 0;
  }

  GaussianDepth sensor_{DepthImage(30, 40, kNone), cv::Mat_<float>(30, 40, kNone)};
  GaussianDepth sfm_{DepthImage(30, 40, 2.1f), cv::Mat_<float>(30, 40, 0.01f)};
};

TEST_F(Rims, DepthIsDroppedNearWhatTheSensorSees) {
  for (const int width : {1, 3, 20}) {
    GaussianDepth sfm{sfm_.mean.clone(), sfm_.variance.clone()};
    dropAtRims(sensor_, width, sfm);
    for (int y = 0; y < 30; ++y) {
      for (int x = 0; x < 40; ++x) {
        const bool dropped = isNear(sensor_.mean > 0.0, x, y, width) && !(sensor_.mean(y, x) > 0.0f);
        EXPECT_EQ(std::isnan(sfm.mean(y, x)), dropped) << "at " << x << ", " << y << ", width " << width;
        EXPECT_EQ(std::isnan(sfm.variance(y, x)), dropped) << "at " << x << ", " << y << ", width " << width;
      }
    }
  }
}

TEST_F(Rims, OfNoWidthDoNothing) {
  dropAtRims(sensor_, 0, sfm_);
  EXPECT_EQ(cv::countNonZero(sfm_.mean == 2.1f), 30 * 40);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
