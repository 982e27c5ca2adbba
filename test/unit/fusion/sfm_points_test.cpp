// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/sfm_points.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "rgbd_sfm_fusion/fusion/gaussian_fusion.h"
#include "unit/fusion/depth_images.h"

namespace rgbd_sfm_fusion {
namespace {

using test::kNone;

class SfmPointsTest : public testing::Test {
 protected:
  SfmPointsTest() {
    sensor_.depth = test::withRelativeSigma(test::constant(size_, 2.0f), 0.01f);
    sfm_ = test::withRelativeSigma(test::constant(size_, kNone), 0.02f);
    for (const cv::Point pixel : kPixels) {
      sfm_.mean(pixel) = 1.0f + static_cast<float>(pixel.x);
      sfm_.variance(pixel) = 0.5f;
    }
  }

  const cv::Size size_{21, 4};  // no multiple of a vector's length
  static constexpr int kLast = 20;
  const std::vector<cv::Point> kPixels{{0, 0}, {kLast, 0}, {7, 2}, {8, 2}, {kLast, 3}};
  SensorDepth sensor_;
  GaussianDepth sfm_;
  SfmPoints points_;
};

TEST_F(SfmPointsTest, AreInTheOrderOfTheImage) {
  sensor_.depth.mean(2, 7) = sensor_.depth.variance(2, 7) = kNone;
  points_.collect(sfm_, sensor_);
  ASSERT_EQ(points_.size(), kPixels.size());
  for (int y = 0; y < size_.height; ++y) {
    for (std::size_t i = points_.begin(y); i < points_.end(y); ++i) {
      EXPECT_EQ(kPixels[i], cv::Point(points_.columns[i], y));
      EXPECT_EQ(points_.sfm[i], 1.0f + static_cast<float>(points_.columns[i]));
      EXPECT_EQ(points_.sfm_variance[i], 0.5f);
      EXPECT_EQ(std::isnan(points_.sensor[i]), i == 2);
      EXPECT_EQ(std::isnan(points_.surface_variance[i]), i == 2) << "that of depth, if there is no other";
      EXPECT_TRUE(std::isnan(points_.of_any_range[i])) << "not known";
    }
  }
}

TEST_F(SfmPointsTest, OfAFrameReplaceThoseBefore) {
  points_.collect(sfm_, sensor_);
  points_.clear();
  EXPECT_EQ(points_.size(), 0u);
  EXPECT_EQ(points_.begin(3), points_.end(3));
  points_.collect(sfm_, sensor_);
  EXPECT_EQ(points_.size(), kPixels.size());
}

TEST_F(SfmPointsTest, TakeImagesOfAnyWidth) {
  SensorDepth other;
  for (const cv::Size size : {cv::Size(64, 48), cv::Size(200, 1), cv::Size(16, 8)}) {
    other.depth = test::withRelativeSigma(test::constant(size, 2.0f), 0.01f);
    points_.collect(other.depth, other);
    EXPECT_EQ(points_.size(), static_cast<std::size_t>(size.area())) << size;
    EXPECT_EQ(points_.columns[points_.size() - 1], size.width - 1);
  }
}

TEST_F(SfmPointsTest, KeepTheirPlacesWhenTheyAreDroppedAndHaveNoSay) {
  sensor_.depth.mean(2, 7) = sensor_.depth.variance(2, 7) = kNone;
  points_.collect(sfm_, sensor_);
  cv::Mat_<std::uint8_t> marked(size_, std::uint8_t{0});
  marked(2, 7) = marked(2, 8) = 1;
  GaussianDepth images{sfm_.mean.clone(), sfm_.variance.clone()};
  points_.dropAndWrite(marked, &images);
  EXPECT_EQ(points_.size(), kPixels.size());
  EXPECT_EQ(images.mean(0, kLast), 1.0f + static_cast<float>(kLast));
  EXPECT_EQ(cv::countNonZero(images.mean > 0.0), static_cast<int>(kPixels.size()) - 2);
  EXPECT_EQ(cv::countNonZero(images.variance > 0.0), static_cast<int>(kPixels.size()) - 2);
  for (const bool test_agreement : {false, true}) {
    GaussianFusionOptions options;
    options.test_agreement = test_agreement;
    const FusedDepth fused = fuse(sensor_, points_, options);
    EXPECT_EQ(fused.provenance(2, 7), static_cast<int>(Provenance::kNone));
    EXPECT_TRUE(std::isnan(fused.depth.mean(2, 7)) && std::isnan(fused.depth.variance(2, 7)));
    EXPECT_EQ(fused.provenance(2, 8), static_cast<int>(Provenance::kSensor));
    EXPECT_EQ(fused.counts.total(), static_cast<std::uint64_t>(size_.area()) - 1);
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
