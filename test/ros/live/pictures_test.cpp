// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Topics of fusion that need the colour image, and what they cost while nobody looks.
#include <sensor_msgs/PointCloud2.h>
#include <visualization_msgs/Marker.h>

#include <cmath>
#include <memory>
#include <set>

#include "cloud_points.h"
#include "live_test.h"
#include "rgbd_sfm_fusion/ros/conversions.h"

namespace rgbd_sfm_fusion {
namespace {

using Image = sensor_msgs::Image;
using PointCloud = sensor_msgs::PointCloud2;

class PicturesTest : public LiveTest {
 protected:
  void SetUp() override {
    camera_.hole = 0.4F;
    start([this] {
      return mean_.isConnected() && variance_.isConnected() && provenance_.isConnected() &&
             live_camera_.colourSubscribers() == 1;
    });
  }

  template <class Message>
  std::unique_ptr<Inbox<Message>> look(const std::string& topic) {
    auto inbox = std::make_unique<Inbox<Message>>(topic);
    EXPECT_TRUE(spinUntil([&] { return inbox->isConnected(); })) << topic;
    return inbox;
  }

  bool colourIsAskedForBy(std::uint32_t subscribers) {
    return spinUntil([&] { return live_camera_.colourSubscribers() == subscribers; });
  }

  /// Sends images one by one, each after the one before was fused. @return the last stamp
  Stamp sendFrames(int count) {
    Stamp stamp = kNoStamp;
    for (int frame = 0; frame < count; ++frame) {
      stamp = live_camera_.send(camera_, frame);
      EXPECT_TRUE(mean_.at(stamp)) << "frame " << frame << " was not fused";
    }
    return stamp;
  }

  Inbox<Image> mean_{"/fusion/mean"};
  Inbox<Image> variance_{"/fusion/variance"};
  Inbox<Image> provenance_{"/fusion/provenance"};
};

TEST_F(PicturesTest, ColourIsSubscribedToOnlyWhileSomebodyLooks) {
  EXPECT_EQ(live_camera_.colourSubscribers(), 1U) << "the tracker";
  for (int round = 0; round < 2; ++round) {
    {
      const auto image = look<Image>("/fusion/image_rect");
      EXPECT_TRUE(colourIsAskedForBy(2));
      const auto preview = look<Image>("/fusion/preview");
    }
    EXPECT_TRUE(colourIsAskedForBy(1));
    {
      const auto points = look<PointCloud>("/fusion/points");
      EXPECT_TRUE(colourIsAskedForBy(2));
    }
    EXPECT_TRUE(colourIsAskedForBy(1));
  }
  const auto added = look<PointCloud>("/fusion/points_added");
  spinUntil([] { return false; }, 0.3);
  EXPECT_EQ(live_camera_.colourSubscribers(), 1U) << "these points are in the legend's colours";
}

TEST_F(PicturesTest, TheRectifiedImageComesForEveryFrameWithItsStampAndSize) {
  const auto rectified = look<Image>("/fusion/image_rect");
  ASSERT_TRUE(colourIsAskedForBy(2));
  std::vector<Stamp> stamps;
  for (int frame = 0; frame < 45; ++frame) {  // at a camera's pace, without waiting for results
    stamps.push_back(live_camera_.send(camera_, frame));
    spinUntil([] { return false; }, 0.05);
  }
  ASSERT_TRUE(mean_.at(stamps.back()));
  ASSERT_TRUE(rectified->at(stamps.back()));
  ASSERT_EQ(rectified->messages.size(), mean_.messages.size());
  for (std::size_t i = 0; i < mean_.messages.size(); ++i) {
    const Image &image = *rectified->messages[i], &mean = *mean_.messages[i];
    ASSERT_EQ(image.header.stamp, mean.header.stamp);
    ASSERT_EQ(image.header.frame_id, mean.header.frame_id);
    ASSERT_EQ(image.width, mean.width);
    ASSERT_EQ(image.height, mean.height);
    ASSERT_EQ(image.encoding, "rgb8");
  }
  EXPECT_EQ(rectified->messages.back()->data, camera_.colour(44)->data)
      << "without distortion it is the same";
}

TEST_F(PicturesTest, GreyStaysGreyAndBgrBecomesRgb) {
  for (const char* encoding : {"mono8", "bgr8"}) {
    camera_.first_stamp = freshStamp();
    camera_.colour_encoding = encoding;
    const auto rectified = look<Image>("/fusion/image_rect");
    ASSERT_TRUE(colourIsAskedForBy(2));
    const auto image = rectified->at(sendFrames(2));
    ASSERT_TRUE(image);
    EXPECT_EQ(image->encoding, std::string(encoding) == "mono8" ? "mono8" : "rgb8");
  }
}

TEST_F(PicturesTest, PointsAreTheProjectionOfTheMeanWithSigmaAndSource) {
  const auto clouds = look<PointCloud>("/fusion/points");
  ASSERT_TRUE(colourIsAskedForBy(2));
  const Stamp stamp = sendFrames(15);
  const auto cloud = clouds->at(stamp);
  ASSERT_TRUE(cloud);
  const cv::Mat_<float> mean = viewImage(mean_.at(stamp)), variance = viewImage(variance_.at(stamp));
  const cv::Mat_<std::uint8_t> provenance = viewImage(provenance_.at(stamp));
  const cv::Mat_<cv::Vec3b> colour = viewImage(camera_.colour(14));
  ASSERT_EQ(cv::Size(static_cast<int>(cloud->width), static_cast<int>(cloud->height)), mean.size());
  EXPECT_EQ(cloud->header.frame_id, camera_.frame_id);
  const CloudPoints points(*cloud);
  std::set<int> sources;
  for (int y = 0; y < mean.rows; ++y) {
    for (int x = 0; x < mean.cols; ++x) {
      const int source = provenance(y, x);
      sources.insert(source);
      ASSERT_EQ(points.label("provenance", y, x), source);
      if (source == 0) {
        ASSERT_TRUE(std::isnan(points.number("x", y, x)) && std::isnan(points.number("z", y, x)));
        continue;
      }
      const auto place = camera_.camera().backProject(x, y, static_cast<double>(mean(y, x)));
      ASSERT_NEAR(points.number("x", y, x), place.x(), 1e-6);
      ASSERT_NEAR(points.number("y", y, x), place.y(), 1e-6);
      ASSERT_EQ(points.number("z", y, x), mean(y, x));
      ASSERT_FLOAT_EQ(points.number("sigma", y, x) * points.number("sigma", y, x), variance(y, x));
      const cv::Vec3b& rgb = colour(y, x);
      ASSERT_EQ(points.rgb(y, x), std::uint32_t{rgb[0]} << 16U | std::uint32_t{rgb[1]} << 8U | rgb[2]);
    }
  }
  EXPECT_GE(sources.size(), 2U) << "none, and something";
}

TEST_F(PicturesTest, ThePreviewIsDrawnOfTheLastFrameAtLast) {
  const auto previews = look<Image>("/fusion/preview");
  ASSERT_TRUE(colourIsAskedForBy(2));
  const Stamp stamp = sendFrames(12);
  const auto preview = previews->at(stamp);
  ASSERT_TRUE(preview);
  EXPECT_EQ(preview->encoding, "rgb8");
  EXPECT_EQ(preview->width, 1280U);
  EXPECT_EQ(preview->height, 720U);
}

TEST_F(PicturesTest, WhatRvizShowsIsSplitByTheSensor) {
  const auto seen = look<PointCloud>("/fusion/points_sensor"),
             added = look<PointCloud>("/fusion/points_added");
  const auto frustum = look<visualization_msgs::Marker>("/fusion/frustum");
  const Stamp stamp = sendFrames(12);
  for (const auto* inbox : {&seen, &added}) {
    const auto cloud = (*inbox)->at(stamp);
    ASSERT_TRUE(cloud);
    const CloudPoints points(*cloud);
    for (int y = 0; y < static_cast<int>(cloud->height); ++y) {
      for (int x = 0; x < static_cast<int>(cloud->width); ++x) {
        const int source = points.label("provenance", y, x);
        ASSERT_TRUE(source == 0 || (source % 2 == 1) == (inbox == &seen)) << source;
      }
    }
  }
  ASSERT_TRUE(frustum->at(stamp));
  EXPECT_EQ(frustum->at(stamp)->header.frame_id, camera_.frame_id);
}

}  // namespace
}  // namespace rgbd_sfm_fusion

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "pictures_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
