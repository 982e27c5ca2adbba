// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/point_cloud.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "cloud_points.h"
#include "rgbd_sfm_fusion/ros/frustum_marker.h"

namespace rgbd_sfm_fusion {
namespace {

const PinholeCamera kCamera{7, 5, 6.0, 5.5, 3.2, 1.9};

/// A frame with every source, and with depths and variances that are all different.
FusedFrame someFrame() {
  FusedFrame fused;
  fused.depth = {cv::Mat_<float>(5, 7), cv::Mat_<float>(5, 7)};
  fused.provenance.create(5, 7);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 7; ++x) {
      const int source = (x + 2 * y) % 5;
      const auto number = static_cast<float>(7 * y + x);
      fused.provenance(y, x) = static_cast<std::uint8_t>(source);
      fused.depth.mean(y, x) = source == 0 ? NAN : 1.0F + 0.1F * number;
      fused.depth.variance(y, x) = source == 0 ? NAN : 1e-4F * (1.0F + number);
    }
  }
  return fused;
}

cv::Mat somePicture() {
  cv::Mat_<cv::Vec3b> picture(5, 7);
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 7; ++x)
      picture(y, x) = {static_cast<std::uint8_t>(10 * x), static_cast<std::uint8_t>(20 * y), 200};
  return picture;
}

std_msgs::Header someHeader() {
  std_msgs::Header header;
  header.stamp = ros::Time(3, 4);
  header.frame_id = "optical";
  return header;
}

/// Expects `cloud` to hold every `step`-th pixel of the frame, and nothing else.
void expectPixels(const sensor_msgs::PointCloud2& cloud, const FusedFrame& fused, int step) {
  const CloudPoints points(cloud);
  for (int v = 0; v < static_cast<int>(cloud.height); ++v) {
    for (int u = 0; u < static_cast<int>(cloud.width); ++u) {
      const int x = step * u, y = step * v;
      ASSERT_EQ(points.label("provenance", v, u), fused.provenance(y, x)) << x << " " << y;
      if (fused.provenance(y, x) == 0) {
        for (const char* field : {"x", "y", "z", "sigma"})
          ASSERT_TRUE(std::isnan(points.number(field, v, u)));
        continue;
      }
      const Eigen::Vector3d place = kCamera.backProject(x, y, static_cast<double>(fused.depth.mean(y, x)));
      ASSERT_FLOAT_EQ(points.number("x", v, u), static_cast<float>(place.x()));
      ASSERT_FLOAT_EQ(points.number("y", v, u), static_cast<float>(place.y()));
      ASSERT_EQ(points.number("z", v, u), fused.depth.mean(y, x));
      ASSERT_FLOAT_EQ(points.number("sigma", v, u) * points.number("sigma", v, u),
                      fused.depth.variance(y, x));
    }
  }
}

TEST(PointCloud, IsTheProjectionOfTheMeanWithItsSigmaAndSource) {
  const FusedFrame fused = someFrame();
  const auto cloud = toPointCloud(someHeader(), fused, kCamera, somePicture(), {});
  EXPECT_EQ(cloud->header.frame_id, "optical");
  EXPECT_EQ(cloud->header.stamp, ros::Time(3, 4));
  EXPECT_EQ(cloud->width, 7U);
  EXPECT_EQ(cloud->height, 5U);
  EXPECT_FALSE(cloud->is_dense);
  EXPECT_EQ(cloud->data.size(), std::size_t{cloud->row_step} * cloud->height);
  expectPixels(*cloud, fused, 1);
  EXPECT_EQ(CloudPoints(*cloud).rgb(1, 4), 0x2814C8U);
}

TEST(PointCloud, DecimationTakesPixels) {
  const FusedFrame fused = someFrame();
  PointCloudOptions options;
  options.decimation = 2;
  const auto cloud = toPointCloud(someHeader(), fused, kCamera, somePicture(), options);
  EXPECT_EQ(cloud->width, 4U);
  EXPECT_EQ(cloud->height, 3U);
  expectPixels(*cloud, fused, 2);
}

TEST(PointCloud, HasTheLegendsColoursAndTheSourcesAskedFor) {
  const FusedFrame fused = someFrame();
  PointCloudOptions options;
  options.colour_by_source = true;
  options.sources = sourceBit(2) | sourceBit(4);
  const auto cloud = toPointCloud(someHeader(), fused, kCamera, {}, options);
  const CloudPoints points(*cloud);
  const std::uint32_t colours[] = {0, 0, 0xFFFF00, 0, 0x0000FF};
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 7; ++x) {
      const int source = fused.provenance(y, x);
      const bool taken = source == 2 || source == 4;
      EXPECT_EQ(std::isfinite(points.number("z", y, x)), taken);
      EXPECT_EQ(points.label("provenance", y, x), taken ? source : 0);
      EXPECT_EQ(points.rgb(y, x), colours[source]);
    }
  }
}

TEST(PointCloud, GreyPicturesGiveGreyPointsAndNoneGivesBlackOnes) {
  const cv::Mat grey(5, 7, CV_8UC1, cv::Scalar(0x55));
  EXPECT_EQ(CloudPoints(*toPointCloud({}, someFrame(), kCamera, grey, {})).rgb(0, 1), 0x555555U);
  EXPECT_EQ(CloudPoints(*toPointCloud({}, someFrame(), kCamera, {}, {})).rgb(0, 1), 0U);
  EXPECT_THROW(toPointCloud({}, someFrame(), kCamera, cv::Mat(4, 7, CV_8UC1), {}), std::invalid_argument);
}

TEST(Frustum, EdgesGoThroughTheImagesCorners) {
  const visualization_msgs::Marker marker = toFrustumMarker(someHeader(), kCamera, 0.5);
  EXPECT_EQ(marker.header.frame_id, "optical");
  ASSERT_EQ(marker.points.size(), 16U) << "four edges from the centre, four around the image";
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  for (const auto& point : marker.points) {
    if (point.z == 0.0) continue;
    EXPECT_DOUBLE_EQ(point.z, 0.5);
    const Eigen::Vector2d pixel = kCamera.project({point.x, point.y, point.z});
    left = std::min(left, pixel.x());
    right = std::max(right, pixel.x());
    top = std::min(top, pixel.y());
    bottom = std::max(bottom, pixel.y());
  }
  EXPECT_NEAR(left, -0.5, 1e-9);
  EXPECT_NEAR(right, 6.5, 1e-9);
  EXPECT_NEAR(top, -0.5, 1e-9);
  EXPECT_NEAR(bottom, 4.5, 1e-9);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
