// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/fusion_messages.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <stdexcept>

#include "rgbd_sfm_fusion/ros/conversions.h"

namespace rgbd_sfm_fusion {
namespace {

FusedFrame someFrame() {
  FusedFrame fused;
  fused.depth.mean = (cv::Mat_<float>(1, 4) << 1, 2, 3, NAN);
  fused.depth.variance = (cv::Mat_<float>(1, 4) << 0.25, 4, 9, NAN);
  fused.provenance = (cv::Mat_<std::uint8_t>(1, 4) << 1, 2, 3, 0);
  fused.disagreement = (cv::Mat_<std::uint8_t>(1, 4) << 2, 0, 1, 0);
  fused.counts.sensor_only = fused.counts.sfm_only = fused.counts.fused = 1;
  fused.disagreeing = 2;
  return fused;
}

sensor_msgs::ImageConstPtr image(const std::string& name, const FusedFrame& fused) {
  std_msgs::Header header;
  header.stamp = ros::Time(3, 4);
  header.frame_id = "optical";
  for (const FusionImageTopic& topic : fusionImageTopics()) {
    if (topic.name == name) return topic.make(header, fused);
  }
  throw std::runtime_error("no image " + name);
}

TEST(FusionMessages, EveryImageHasItsEncodingSizeAndHeader) {
  const std::map<std::string, std::string> encodings = {
      {"mean", "32FC1"},       {"variance", "32FC1"},     {"standard_deviation", "32FC1"},
      {"provenance", "mono8"}, {"disagreement", "mono8"}, {"provenance_color", "rgb8"},
      {"sfm_depth", "32FC1"},  {"sfm_variance", "32FC1"}};
  EXPECT_EQ(fusionImageTopics().size(), encodings.size());
  for (const auto& [name, encoding] : encodings) {
    const auto message = image(name, someFrame());
    EXPECT_EQ(message->encoding, encoding) << name;
    EXPECT_EQ(message->width, 4U) << name;
    EXPECT_EQ(message->height, 1U) << name;
    EXPECT_EQ(message->header.stamp, ros::Time(3, 4)) << name;
    EXPECT_EQ(message->header.frame_id, "optical") << name;
  }
}

TEST(FusionMessages, StandardDeviationIsTheRootOfTheVariance) {
  const cv::Mat_<float> sigma = viewImage(image("standard_deviation", someFrame())).clone();
  EXPECT_FLOAT_EQ(sigma(0, 0), 0.5F);
  EXPECT_FLOAT_EQ(sigma(0, 2), 3.0F);
  EXPECT_TRUE(std::isnan(sigma(0, 3)));
}

TEST(FusionMessages, ProvenanceHasThePapersColours) {
  const cv::Mat_<cv::Vec3b> colours = viewImage(image("provenance_color", someFrame())).clone();
  EXPECT_EQ(colours(0, 0), cv::Vec3b(255, 255, 255));
  EXPECT_EQ(colours(0, 1), cv::Vec3b(255, 255, 0));
  EXPECT_EQ(colours(0, 2), cv::Vec3b(255, 0, 0));
  EXPECT_EQ(colours(0, 3), cv::Vec3b(0, 0, 0));
}

TEST(FusionMessages, CompletedPixelsAreBlue) {
  FusedFrame fused = someFrame();
  fused.provenance.setTo(4);
  const cv::Mat_<cv::Vec3b> colours = viewImage(image("provenance_color", fused)).clone();
  EXPECT_EQ(colours(0, 0), cv::Vec3b(0, 0, 255));
}

TEST(FusionMessages, StatisticsCountWhatIsCompletedApart) {
  FusedFrame fused = someFrame();
  fused.counts.completed = 3;
  fused.counts.without = 4;
  FusionTotals totals;
  totals.add(fused);
  const FusionStatistics message = toStatisticsMessage({}, fused, totals, 0.0, 0.0);
  EXPECT_EQ(message.pixels_with_depth, 3U);
  EXPECT_DOUBLE_EQ(message.sfm_only, 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(message.completed, 0.3);
  EXPECT_DOUBLE_EQ(message.refilled, 0.5);
  EXPECT_DOUBLE_EQ(message.total_completed, 0.3);
  EXPECT_DOUBLE_EQ(message.total_refilled, 0.5);
}

TEST(FusionMessages, OnlyPicturesForPeopleMayLoseSomething) {
  for (const FusionImageTopic& topic : fusionImageTopics())
    EXPECT_EQ(topic.is_picture, topic.name == "provenance_color") << topic.name;
}

TEST(FusionMessages, PicturesAreRgbOrGrey) {
  EXPECT_EQ(toPictureMessage({}, cv::Mat(2, 3, CV_8UC3))->encoding, "rgb8");
  EXPECT_EQ(toPictureMessage({}, cv::Mat(2, 3, CV_8UC1))->encoding, "mono8");
}

TEST(FusionMessages, WithoutSfmItsImagesAreEmptyOfValues) {
  const cv::Mat_<float> depth = viewImage(image("sfm_depth", someFrame())).clone();
  for (const float value : depth) EXPECT_TRUE(std::isnan(value));
  FusedFrame fused = someFrame();
  fused.sfm = fused.depth;
  EXPECT_EQ((cv::Mat_<float>(viewImage(image("sfm_depth", fused)))(0, 1)), 2.0F);
}

TEST(FusionMessages, StatisticsGiveSharesOfTheFrameAndOfAll) {
  FusionTotals totals;
  totals.add(someFrame());
  FusedFrame second = someFrame();
  second.counts.fused = 5;
  totals.add(second);
  const FusionStatistics message = toStatisticsMessage({}, second, totals, 0.1, -0.01);
  EXPECT_EQ(message.pixels_with_depth, 7U);
  EXPECT_DOUBLE_EQ(message.fused, 5.0 / 7.0);
  EXPECT_DOUBLE_EQ(message.disagreement, 2.0 / 7.0);
  EXPECT_EQ(message.total_pixels_with_depth, 10U);
  EXPECT_DOUBLE_EQ(message.total_fused, 0.6);
  EXPECT_DOUBLE_EQ(message.total_disagreement, 0.4);
  EXPECT_EQ(message.skew, -0.01);
}

TEST(FusionMessages, AFrameWithoutDepthHasNoShares) {
  const FusionStatistics message = toStatisticsMessage({}, FusedFrame(), FusionTotals(), 0.0, 0.0);
  EXPECT_EQ(message.fused, 0.0);
  EXPECT_EQ(message.disagreement, 0.0);
  EXPECT_EQ(message.total_disagreement, 0.0);
}

TEST(FusionMessages, SkewIsNoNumberWithoutDepth) {
  EXPECT_TRUE(std::isnan(skewSeconds(5, kNoStamp)));
  EXPECT_DOUBLE_EQ(skewSeconds(1'000'000'000, 990'000'000), -0.01);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
