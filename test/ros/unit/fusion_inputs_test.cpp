// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/fusion_inputs.h"

#include <gtest/gtest.h>
#include <boost/make_shared.hpp>
#include <boost/weak_ptr.hpp>

#include <vector>

namespace rgbd_sfm_fusion {
namespace {

const ros::Time kNow(1000.0);
const ros::Time kLater(1010.0);

TrackedFrameConstPtr tracked(double stamp, double depth, double keyframe = 0.0, std::uint32_t revision = 0) {
  auto message = boost::make_shared<TrackedFrame>();
  message->header.stamp = ros::Time(stamp);
  message->state = keyframe > 0.0 ? TrackedFrame::TRACKING : TrackedFrame::INITIALISING;
  message->depth_stamp = ros::Time(depth);
  message->keyframe_stamp = ros::Time(keyframe);
  message->keyframe_revision = revision;
  return message;
}

sensor_msgs::ImageConstPtr depth(double stamp) {
  auto message = boost::make_shared<sensor_msgs::Image>();
  message->header.stamp = ros::Time(stamp);
  return message;
}

KeyframeConstPtr keyframe(double stamp, std::uint32_t revision) {
  auto message = boost::make_shared<Keyframe>();
  message->header.stamp = ros::Time(stamp);
  message->revision = revision;
  return message;
}

TEST(FusionInputs, GivesAFrameWhatItNames) {
  FusionInputs inputs(10);
  for (const double stamp : {0.9, 1.0, 1.1}) inputs.pushDepth(depth(stamp));
  for (const std::uint32_t revision : {3U, 4U, 5U}) inputs.pushKeyframe(keyframe(0.5, revision));
  inputs.pushTracked(tracked(1.01, 1.0, 0.5, 4), kNow);
  const auto frame = inputs.pop(kNow);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->depth->header.stamp, ros::Time(1.0));
  EXPECT_EQ(frame->keyframe->revision, 4U);
  EXPECT_EQ(frame->missing, "");
  EXPECT_FALSE(inputs.pop(kLater));
}

TEST(FusionInputs, NeedsNothingWhereNothingIsNamed) {
  FusionInputs inputs(10);
  inputs.pushTracked(tracked(1.0, 0.0), kNow);
  const auto frame = inputs.pop(kNow);
  ASSERT_TRUE(frame);
  EXPECT_FALSE(frame->depth);
  EXPECT_FALSE(frame->keyframe);
  EXPECT_EQ(frame->missing, "");
}

TEST(FusionInputs, WaitsForItsColourImageOnceOneHasCome) {
  FusionInputs inputs(10);
  inputs.pushTracked(tracked(1.0, 0.0), kNow);
  const auto without = inputs.pop(kNow);
  ASSERT_TRUE(without);  // nobody sends colour
  EXPECT_FALSE(without->colour);
  EXPECT_EQ(without->missing, "");
  inputs.pushColour(depth(1.9));
  inputs.pushTracked(tracked(2.0, 0.0), kNow);
  EXPECT_FALSE(inputs.pop(kNow));
  inputs.pushColour(depth(2.0));
  const auto frame = inputs.pop(kNow);
  ASSERT_TRUE(frame);
  ASSERT_TRUE(frame->colour);
  EXPECT_EQ(frame->colour->header.stamp, ros::Time(2.0));
  inputs.pushColour(depth(2.2));  // that of 2.1 was lost
  inputs.pushTracked(tracked(2.1, 0.0), kNow);
  ASSERT_TRUE(inputs.pop(kNow));
  inputs.pushTracked(tracked(2.3, 0.0), kNow);
  EXPECT_FALSE(inputs.pop(kNow));
  EXPECT_EQ(inputs.pop(kLater)->missing, "its colour image");
  inputs.forgetColour();
  inputs.pushTracked(tracked(2.4, 0.0), kNow);
  EXPECT_TRUE(inputs.pop(kNow));
}

TEST(FusionInputs, WaitsForWhatHasNotComeButNotForEver) {
  FusionInputs inputs(10);
  inputs.pushTracked(tracked(1.0, 1.0, 1.0), kNow);
  inputs.pushDepth(depth(1.0));
  EXPECT_FALSE(inputs.pop(kNow));
  inputs.pushKeyframe(keyframe(1.0, 0));
  EXPECT_TRUE(inputs.pop(kNow));

  inputs.pushTracked(tracked(2.0, 2.0, 2.0), kNow);
  EXPECT_FALSE(inputs.pop(kNow));
  const auto frame = inputs.pop(kLater);
  ASSERT_TRUE(frame);
  EXPECT_NE(frame->missing.find("depth"), std::string::npos);
  EXPECT_NE(frame->missing.find("keyframe"), std::string::npos);
}

/// ROS's clock stops or slows down while a bag is paused or played slowly.
TEST(FusionInputs, WaitsAsLongAsTheClockStands) {
  FusionInputs inputs(10);
  inputs.pushTracked(tracked(1.0, 1.0), kNow);
  for (int look = 0; look < 100; ++look) ASSERT_FALSE(inputs.pop(kNow));
  inputs.pushDepth(depth(1.0));
  EXPECT_TRUE(inputs.pop(kNow)->depth);
}

TEST(FusionInputs, DoesNotWaitForWhatIsBeforeAJumpBackOfTheClock) {
  FusionInputs inputs(10);
  inputs.pushTracked(tracked(9.0, 9.0), kLater);
  EXPECT_FALSE(inputs.pop(kLater));
  ASSERT_TRUE(inputs.pop(kNow));
}

TEST(FusionInputs, TellsHowNearDepthCame) {
  FusionInputs inputs(10);
  for (const double stamp : {0.9, 1.04, 1.1}) inputs.pushDepth(depth(stamp));
  inputs.pushTracked(tracked(1.0, 0.0), kNow);
  EXPECT_EQ(inputs.pop(kNow)->nearest_depth, ros::Time(1.04));
}

TEST(FusionInputs, TakesTheNearestRevisionThatCame) {
  FusionInputs inputs(10);
  inputs.pushKeyframe(keyframe(0.5, 2));
  inputs.pushKeyframe(keyframe(0.5, 8));
  inputs.pushTracked(tracked(1.0, 0.0, 0.5, 7), kNow);
  EXPECT_EQ(inputs.pop(kNow)->keyframe->revision, 2U);
  inputs.pushKeyframe(keyframe(0.8, 9));
  inputs.pushTracked(tracked(1.0, 0.0, 0.8, 7), kNow);
  EXPECT_EQ(inputs.pop(kNow)->keyframe->revision, 9U);
}

TEST(FusionInputs, KeyframesOfAnotherRunAreNotMistaken) {
  FusionInputs inputs(10);
  inputs.pushKeyframe(keyframe(0.5, 0));
  auto of_new_run = boost::make_shared<TrackedFrame>(*tracked(0.5, 0.0, 0.5, 0));
  of_new_run->run = 1;
  inputs.pushTracked(of_new_run, kNow);
  EXPECT_FALSE(inputs.pop(kNow));
  auto its_keyframe = boost::make_shared<Keyframe>(*keyframe(0.5, 0));
  its_keyframe->run = 1;
  inputs.pushKeyframe(its_keyframe);
  EXPECT_EQ(inputs.pop(kNow)->keyframe, its_keyframe);
}

TEST(FusionInputs, DepthThatComesBeforeItsFrameSurvivesAJumpBackOfStamps) {
  FusionInputs inputs(10);
  inputs.pushDepth(depth(9.0));
  inputs.pushTracked(tracked(9.0, 9.0), kNow);
  EXPECT_TRUE(inputs.pop(kNow)->depth);
  inputs.pushDepth(depth(1.0));
  inputs.pushTracked(tracked(1.0, 1.0), kNow);
  EXPECT_TRUE(inputs.pop(kNow)->depth);
}

/// As where a bag is played in a loop.
TEST(FusionInputs, ImagesFromBeforeAJumpBackOfStampsGoWithTheFirstFrameAfterIt) {
  FusionInputs inputs(10);
  std::vector<boost::weak_ptr<const sensor_msgs::Image>> before;
  const auto send = [&](double stamp) {
    const auto image = depth(stamp), colour = depth(stamp);
    inputs.pushDepth(image);
    inputs.pushColour(colour);
    return std::vector<boost::weak_ptr<const sensor_msgs::Image>>{image, colour};
  };
  for (const double stamp : {8.0, 9.0}) {  // not fused any more
    for (const auto& image : send(stamp)) before.push_back(image);
  }
  send(1.0);
  inputs.pushTracked(tracked(1.0, 1.0), kNow);
  const auto frame = inputs.pop(kNow);
  ASSERT_TRUE(frame);
  EXPECT_TRUE(frame->depth);
  EXPECT_TRUE(frame->colour);
  for (const auto& image : before) EXPECT_TRUE(image.expired());
}

TEST(FusionInputs, OneDepthImageMayServeTwoFrames) {
  FusionInputs inputs(10);
  inputs.pushDepth(depth(1.0));
  inputs.pushTracked(tracked(1.00, 1.0), kNow);
  inputs.pushTracked(tracked(1.01, 1.0), kNow);
  EXPECT_TRUE(inputs.pop(kNow)->depth);
  EXPECT_TRUE(inputs.pop(kNow)->depth);
}

TEST(FusionInputs, KeepsOrderAndDropsTheOldest) {
  FusionInputs inputs(2);
  EXPECT_FALSE(inputs.pushTracked(tracked(1.0, 0.0), kNow));
  EXPECT_FALSE(inputs.pushTracked(tracked(2.0, 0.0), kNow));
  EXPECT_TRUE(inputs.pushTracked(tracked(3.0, 0.0), kNow));
  EXPECT_EQ(inputs.pop(kNow)->tracked->header.stamp, ros::Time(2.0));
  EXPECT_EQ(inputs.pop(kNow)->tracked->header.stamp, ros::Time(3.0));
}

TEST(FusionInputs, AnOldKeyframesRevisionsGoWithIt) {
  FusionInputs inputs(10);
  for (std::uint32_t revision = 0; revision < 5; ++revision) inputs.pushKeyframe(keyframe(0.5, revision));
  inputs.pushKeyframe(keyframe(1.0, 0));
  inputs.pushTracked(tracked(1.0, 0.0, 1.0, 0), kNow);
  EXPECT_EQ(inputs.pop(kNow)->keyframe->header.stamp, ros::Time(1.0));
  inputs.pushTracked(tracked(1.1, 0.0, 1.0, 0), kNow);
  EXPECT_EQ(inputs.pop(kNow)->keyframe->header.stamp, ros::Time(1.0));
}

}  // namespace
}  // namespace rgbd_sfm_fusion
