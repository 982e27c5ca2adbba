// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/tracker_story.h"

#include <gtest/gtest.h>

#include <vector>

namespace rgbd_sfm_fusion {
namespace {

constexpr Stamp kPeriod = 33'000'000;

/// The story of a sequence of states: i(nitialising), t(racking), l(ost), j(umped, and tracking).
std::vector<std::string> tell(const std::string& states, bool has_depth = true) {
  TrackerStory story;
  std::vector<std::string> lines;
  TrackingResult tracked;
  for (const char state : states) {
    tracked.stamp += kPeriod;
    tracked.state = state == 'i'   ? TrackingState::kInitialising
                    : state == 'l' ? TrackingState::kLost
                                   : TrackingState::kTracking;
    tracked.relocalised = state == 'j';
    const auto line = story.tell(tracked, has_depth);
    if (line) lines.push_back((line->is_warning ? "W " : "I ") + line->text.substr(0, 20));
  }
  return lines;
}

TEST(TrackerStory, TellsEachChangeOnce) {
  EXPECT_EQ(tell("iiiittttt"), (std::vector<std::string>{"I waiting for an image", "I tracking"}));
  EXPECT_EQ(tell("iii", false), (std::vector<std::string>{"I images come; waiting"}));
}

TEST(TrackerStory, TellsOfALossThatLasts) {
  EXPECT_EQ(tell("tttltttltt"), std::vector<std::string>{"I tracking"}) << "single frames are no story";
  const std::string loss(20, 'l'), while_all_is_well(400, 't');
  const auto lines = tell("tt" + loss + "j" + while_all_is_well + loss + "tt");
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_EQ(lines[1].substr(0, 6), "W lost");
  EXPECT_EQ(lines[2], "I tracking again after");
  EXPECT_EQ(lines[4], "I tracking again after");
  std::string again_and_again = "tt";
  for (int i = 0; i < 12; ++i) again_and_again += loss + "tttt";
  EXPECT_EQ(tell(again_and_again).size(), 3U) << "of ten seconds";
}

TEST(TrackerStory, SaysHowLongALossWasAndWhetherThePoseJumped) {
  TrackerStory story;
  TrackingResult tracked;
  const auto at = [&](double seconds, TrackingState state) {
    tracked.stamp = fromSeconds(seconds);
    tracked.state = state;
    return story.tell(tracked, true);
  };
  at(1.0, TrackingState::kTracking);
  at(2.0, TrackingState::kLost);
  ASSERT_TRUE(at(2.5, TrackingState::kLost));
  tracked.relocalised = true;
  const auto found = at(4.3, TrackingState::kTracking);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->text, "tracking again after 2.3 s: the pose has jumped");
}

TEST(TrackerStory, SaysOnceThatTheShutterIsKnown) {
  TrackerStory story;
  TrackingResult tracked;
  tracked.state = TrackingState::kTracking;
  tracked.readout_time = 0.0308;
  tracked.readout_sigma = 0.01;
  story.tell(tracked, true);
  EXPECT_FALSE(story.tell(tracked, true)) << "not known yet";
  tracked.readout_sigma = 0.0;
  EXPECT_FALSE(story.tell(tracked, true)) << "it is set, and not learned";
  tracked.readout_sigma = 0.002;
  EXPECT_EQ(story.tell(tracked, true)->text, "the shutter is known: an image is read in 31 ms");
  EXPECT_FALSE(story.tell(tracked, true));
}

TEST(TrackerStory, SaysOnceThatTheCalibrationIsOff) {
  TrackerStory story;
  TrackingResult tracked;
  tracked.state = TrackingState::kTracking;
  tracked.principal_point_sigma = {2.0, 3.0};
  story.tell(tracked, true);
  EXPECT_FALSE(story.tell(tracked, true)) << "no sign of it";
  tracked.principal_point_correction = {-5.0, 4.0};
  tracked.principal_point_sigma = {1.0, 1.4};
  const auto line = story.tell(tracked, true);
  ASSERT_TRUE(line);
  EXPECT_TRUE(line->is_warning);
  EXPECT_EQ(line->text.substr(0, 85),
            "the calibration looks off: the principal point is (-5.0, 4.0) px from that of camera_");
  EXPECT_FALSE(story.tell(tracked, true));
}

TEST(TrackerStory, SaysOnceThatDepthIsOlderThanItsStamps) {
  TrackerStory story;
  TrackingResult tracked;
  tracked.state = TrackingState::kTracking;
  tracked.depth_delay_sigma = 0.01;
  story.tell(tracked, true);
  EXPECT_FALSE(story.tell(tracked, true)) << "no sign of it";
  tracked.depth_delay = 0.0151;
  tracked.depth_delay_sigma = 0.002;
  EXPECT_EQ(story.tell(tracked, true)->text,
            "depth images are 15.1 ms older than their stamps say, with a sigma of 2.0 ms. With "
            "compensate_skew, poses and fused depth take this into account");
  EXPECT_FALSE(story.tell(tracked, true));
}

}  // namespace
}  // namespace rgbd_sfm_fusion
