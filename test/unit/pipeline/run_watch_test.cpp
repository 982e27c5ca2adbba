// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/pipeline/run_watch.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace rgbd_sfm_fusion {
namespace {

using LeftOut = RunWatch::LeftOut;

DepthValues valuesOfAll(float depth) {
  return valuesOf(DepthImage(48, 64, depth), 0.4, 5.0);
}

/// A frame in which everything is as it should be.
RunWatch::Frame goodFrame() {
  RunWatch::Frame frame;
  frame.skew = 0.005;
  frame.depth = valuesOfAll(2.0F);
  frame.state = TrackingState::kTracking;
  frame.scale.emplace();
  frame.scale->alpha = 1.0;
  frame.counts = {100, 10, 50};
  return frame;
}

RunWatch watchOf(const RunWatch::Frame& frame, int count = 60) {
  RunWatch watch{RunWatch::Limits()};
  for (int i = 0; i < count; ++i) watch.add(0.033 * i, frame);
  return watch;
}

void expectSaid(const RunWatch& watch, const std::vector<std::string>& parts) {
  std::string all;
  for (const std::string& sentence : watch.sentences()) all += sentence + "\n";
  for (const std::string& part : parts)
    EXPECT_NE(all.find(part), std::string::npos) << part << "\nin: " << all;
}

TEST(RunWatch, HasNothingToSayOfAGoodRun) {
  const RunWatch watch = watchOf(goodFrame());
  EXPECT_TRUE(watch.sentences().empty()) << watch.sentences()[0];
  EXPECT_FALSE(watch.hasNothing());
}

TEST(RunWatch, ALossAmongTrackedImages) {
  RunWatch watch = watchOf(goodFrame(), 99);
  RunWatch::Frame lost = goodFrame();
  lost.state = TrackingState::kLost;
  watch.add(3.3, lost);
  EXPECT_TRUE(watch.sentences().empty()) << "one of a hundred is found again at the next";
  EXPECT_TRUE(watch.recentSentences(3.3).empty());
  for (int i = 1; i < 11; ++i) watch.add(3.3 + 0.033 * i, lost);
  expectSaid(watch,
             {"11 of 110 images have no pose", "tracking was lost", "something that moves", "blurred"});
}

TEST(RunWatch, NoImages) {
  RunWatch watch{RunWatch::Limits()};
  expectSaid(watch, {"colour: no image came"});
  EXPECT_TRUE(watch.hasNothing());
  watch.leftOutColour(0.0, LeftOut::kUnstamped, 7);
  watch.leftOutDepth(0.0, LeftOut::kUnstamped, 8);
  expectSaid(watch, {"colour: all 7 images have a stamp of 0: ", "depth: all 8 images have a stamp of 0: "});
  watch.leftOutColour(0.0, LeftOut::kLate, 2);
  expectSaid(watch, {"all 9 images were left out (7 with a stamp of 0, 2 late, 0 that cannot be used)"});
}

TEST(RunWatch, DepthThatIsNeverNearEnoughInTime) {
  RunWatch::Frame frame = goodFrame();
  frame.skew = -0.045;
  frame.depth.reset();
  frame.state = TrackingState::kInitialising;
  frame.counts = {};
  frame.scale->alpha = 0.0;
  const RunWatch watch = watchOf(frame);
  expectSaid(watch,
             {"for all 60 colour images, no depth is within max_skew (20 ms): the nearest is 45 ms away",
              "max_skew=0.05", "all 60 images were not tracked (60 initialising, 0 lost)"});
  EXPECT_TRUE(watch.hasNothing());
  frame.skew = 3600.0;
  expectSaid(watchOf(frame), {"must be stamped by the same clock"});
  frame.skew.reset();
  expectSaid(watchOf(frame), {"depth: no image came"});
}

TEST(RunWatch, DepthThatCannotBeUsed) {
  RunWatch::Frame frame = goodFrame();
  frame.depth.reset();
  RunWatch watch = watchOf(frame);
  watch.leftOutDepth(0.0, LeftOut::kUnusable, 60);
  expectSaid(watch, {"all 60 colour images are without depth, as all 60 images cannot be used"});
}

TEST(RunWatch, DepthInAnotherUnit) {
  RunWatch::Frame frame = goodFrame();
  frame.depth = valuesOfAll(20.0F);  // 2 m in units of 0.1 mm
  expectSaid(watchOf(frame), {"100 % of the depth values are beyond 10.5 m", "typical are 20.0 m",
                              "another unit", "set depth_scale"});
  frame.depth = valuesOfAll(0.002F);  // 2 m in metres, read as millimetres
  expectSaid(watchOf(frame),
             {"100 % of the depth values are nearer than min_range (0.4 m)", "0.0020 m", "another unit"});
  DepthImage depth(8, 8);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) depth(y, x) = 0.005F * static_cast<float>(801 + x + 8 * y);
  }
  frame.depth = valuesOf(depth, 0.4, 5.0);  // 0.8 m in TUM's counts
  expectSaid(watchOf(frame), {"multiples of 5 mm", "set depth_scale=0.0002"});
  frame.depth = valuesOfAll(8.0F);
  expectSaid(watchOf(frame), {"100 % of the depth values are beyond max_range (5.0 m)", "raise max_range"});
  frame.depth = valuesOfAll(std::numeric_limits<float>::quiet_NaN());
  expectSaid(watchOf(frame), {"no pixel has a depth"});
}

TEST(RunWatch, SfmThatIsNotUsed) {
  RunWatch::Frame frame = goodFrame();
  frame.scale->alpha = std::numeric_limits<double>::quiet_NaN();
  expectSaid(watchOf(frame), {"SfM's depth had no scale in all 60 tracked images"});
  frame = goodFrame();
  frame.sfm_rejected = true;
  expectSaid(watchOf(frame), {"contradicts the sensor's in all 60 tracked images"});
  frame = goodFrame();
  frame.counts.sfm_only = 0;
  frame.depth->with_depth /= 2;
  expectSaid(watchOf(frame), {"nothing comes from SfM alone in all 60 tracked images"});
  EXPECT_FALSE(watchOf(frame).hasNothing()) << "sensor depth is still improved";
}

TEST(RunWatch, TellsTheLastSecondsFromTheWhole) {
  RunWatch watch = watchOf(goodFrame());  // until 2 s
  RunWatch::Frame frame = goodFrame();
  frame.depth.reset();
  frame.skew = 0.045;
  for (int i = 0; i < 30; ++i) watch.add(10.0 + 0.033 * i, frame);
  EXPECT_TRUE(watch.sentences().empty()) << "most frames have depth";
  ASSERT_EQ(watch.recentSentences(11.0).size(), 1U);
  EXPECT_NE(watch.recentSentences(11.0)[0].find("the nearest is 45 ms away"), std::string::npos);
  EXPECT_TRUE(watch.recentSentences(100.0).empty()) << "who subscribes knows that nothing comes";
  watch.add(1.0, goodFrame());
  EXPECT_TRUE(watch.recentSentences(1.0).empty()) << "a clock that went back";
}

TEST(RunWatch, AStageNeedNotKnowOfTheOthers) {
  RunWatch::Frame frame = goodFrame();
  frame.scale.reset();
  EXPECT_TRUE(watchOf(frame).sentences().empty());
  frame = goodFrame();
  frame.state.reset();
  EXPECT_TRUE(watchOf(frame).sentences().empty());
}

}  // namespace
}  // namespace rgbd_sfm_fusion
