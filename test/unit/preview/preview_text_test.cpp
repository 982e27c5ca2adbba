// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/preview/preview_text.h"

#include <gtest/gtest.h>

#include <set>

#include "preview_frames.h"
#include "rgbd_sfm_fusion/preview/stamp_rate.h"

namespace rgbd_sfm_fusion {
namespace {

TEST(PreviewText, SharesAreOfAllPixels) {
  const PreviewShares shares = sharesOf(stripedFrame({100, 4}));
  for (const double share : shares.by_source) EXPECT_DOUBLE_EQ(share, 0.2);
  EXPECT_DOUBLE_EQ(shares.sensor, 0.4);
  EXPECT_DOUBLE_EQ(shares.sfm, 0.4);
  EXPECT_DOUBLE_EQ(shares.fused(), 0.8);
  EXPECT_DOUBLE_EQ(shares.refilled, 2.0 / 3.0) << "2 and 4 of 0, 2 and 4";
}

TEST(PreviewText, WithoutADepthImageAllPixelsAreHoles) {
  PreviewFrame frame = stripedFrame({100, 4});
  frame.sensor.release();
  EXPECT_DOUBLE_EQ(sharesOf(frame).refilled, 0.8);
  EXPECT_EQ(sharesOf(frame).sensor, 0.0);
}

TEST(PreviewText, ASensorThatSeesEverythingLeavesNothingToRefill) {
  PreviewFrame frame = stripedFrame({100, 4});
  frame.sensor.setTo(1.0F);
  EXPECT_EQ(sharesOf(frame).refilled, 0.0);
  EXPECT_NE(refilledText(sharesOf(frame)).find("nothing to refill"), std::string::npos);
}

TEST(PreviewText, EveryStateHasItsWords) {
  PreviewFrame frame = stripedFrame({10, 4});
  EXPECT_EQ(describeState(frame).text, "tracking");
  EXPECT_EQ(describeState(frame).mood, PreviewMood::kGood);
  std::set<std::string> texts = {"tracking"};
  frame.fused.scale = {};
  EXPECT_EQ(describeState(frame).text, "starting: needs motion");
  EXPECT_EQ(describeState(frame).mood, PreviewMood::kWaiting);
  texts.insert(describeState(frame).text);
  frame.fused.sfm_rejected = true;
  texts.insert(describeState(frame).text);
  frame.state = TrackingState::kLost;
  EXPECT_EQ(describeState(frame).text, "lost: sensor depth only");
  EXPECT_EQ(describeState(frame).mood, PreviewMood::kBad);
  texts.insert(describeState(frame).text);
  frame.state = TrackingState::kInitialising;
  EXPECT_EQ(describeState(frame).mood, PreviewMood::kWaiting);
  texts.insert(describeState(frame).text);
  EXPECT_EQ(texts.size(), 5U);
}

TEST(PreviewText, NumbersHaveUnits) {
  PreviewFrame frame = stripedFrame({10, 4});
  EXPECT_EQ(speedText(frame), "30.0 frames/s, 45 ms behind");
  frame.latency = -0.01;
  EXPECT_EQ(speedText(frame), "30.0 frames/s, 0 ms behind") << "a simulated clock between two ticks";
  for (const double latency : {-1e9, 1e9}) {
    frame.latency = latency;
    EXPECT_EQ(speedText(frame), "30.0 frames/s, clock not set");
  }
  EXPECT_EQ(speedText(PreviewFrame()), "rate not known yet, offline");
  EXPECT_EQ(scaleText(frame.fused.scale), "scale of SfM: 1.000 +- 0.002");
  EXPECT_EQ(scaleText({}), "scale of SfM: not known yet");
  EXPECT_EQ(percentText(0.0), "0 %");
  EXPECT_EQ(percentText(0.004), "0.4 %");
  EXPECT_EQ(percentText(0.0997), "10 %");
  EXPECT_EQ(percentText(1.0), "100 %");
}

TEST(StampRate, IsThatOfTheLastSecond) {
  StampRate rate;
  EXPECT_TRUE(std::isnan(rate.rate()));
  Stamp stamp = 0;
  for (int i = 0; i < 30; ++i) rate.add(stamp += 100'000'000);
  EXPECT_NEAR(rate.rate(), 10.0, 1e-9);
  for (int i = 0; i < 60; ++i) rate.add(stamp += 20'000'000);
  EXPECT_NEAR(rate.rate(), 50.0, 1e-9);
}

TEST(StampRate, StartsAnewWhereStampsGoBack) {
  StampRate rate;
  rate.add(5'000'000'000);
  rate.add(5'100'000'000);
  rate.add(1'000'000'000);
  EXPECT_TRUE(std::isnan(rate.rate()));
  rate.add(1'050'000'000);
  EXPECT_NEAR(rate.rate(), 20.0, 1e-9);
}

TEST(StampRate, IsKnownOfSlowFrames) {
  StampRate rate;
  for (const Stamp stamp : {1, 3, 5}) rate.add(stamp * 1'000'000'000);
  EXPECT_NEAR(rate.rate(), 0.5, 1e-9);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
