// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// replay with a stand-in for roslaunch: what it finds in bags, and which arguments replay.launch gets.
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <std_msgs/String.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "fuse_bag_fixture.h"
#include "input_forms.h"

namespace rgbd_sfm_fusion {
namespace {

class ReplayTest : public FuseBagTest {
 protected:
  void SetUp() override {
    FuseBagTest::SetUp();
    std::ofstream(folder() + "/roslaunch") << "#!/bin/sh\nprintf '<%s>\\n' \"$@\"\n";
    fs::permissions(folder() + "/roslaunch", fs::perms::owner_all);
  }

  /// Runs in the folder of the bags. @return one line for each argument that roslaunch got, in < >
  static Outcome replay(const std::string& arguments) {
    return runCommand("cd " + folder() + " && HOME=" + folder() + " PATH=" + folder() + ":$PATH " + REPLAY +
                      " " + arguments);
  }

  static void expectArguments(const Outcome& outcome, const std::vector<std::string>& expected) {
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    for (const std::string& argument : expected)
      EXPECT_NE(outcome.output.find("<" + argument + ">\n"), std::string::npos) << argument << " is not in\n"
                                                                                << outcome.output;
  }

  static void expectRefused(const std::string& arguments, const std::vector<std::string>& parts) {
    const Outcome outcome = replay(arguments);
    EXPECT_EQ(outcome.status, 1) << outcome.output;
    EXPECT_EQ(outcome.output.find('<'), std::string::npos) << "nothing is started";
    for (const std::string& part : parts)
      EXPECT_NE(outcome.output.find(part), std::string::npos) << part << " is not in\n" << outcome.output;
  }
};

TEST_F(ReplayTest, NamesTheTopicsThatAreInTheBag) {
  const Outcome outcome = replay("in.bag rviz:=false rate:=2");
  expectArguments(outcome,
                  {"rgbd_sfm_fusion", "replay.launch", "bag:=" + input(), "rgb_topic:=/camera/rgb/image_raw",
                   "depth_topic:=/camera/depth_registered/image_raw",
                   "camera_info_topic:=/camera/rgb/camera_info", "rviz:=false", "rate:=2"});
  EXPECT_NE(outcome.output.find("replay: colour /camera/rgb/image_raw, depth "), std::string::npos);
  EXPECT_EQ(outcome.output.find("transport"), std::string::npos) << outcome.output;
}

TEST_F(ReplayTest, CompressedImagesAreNamedByTheirTransport) {
  writeFrames(
      folder() + "/small.bag",
      [](rosbag::Bag& bag, const FakeCamera& camera, int frame, const ros::Time& arrival) {
        bag.write("/cam/info/camera_info", arrival, camera.info(frame));
        bag.write("/cam/colour/compressed", arrival, compress(camera.colour(frame), "jpeg", 0));
        bag.write("/cam/depth/compressedDepth", arrival,
                  compress(camera.depthImage(frame), "16UC1; compressedDepth", 12));
      },
      0, 1);
  expectArguments(replay("small.bag"),
                  {"rgb_topic:=/cam/colour", "rgb_transport:=compressed", "depth_topic:=/cam/depth",
                   "depth_transport:=compressedDepth", "camera_info_topic:=/cam/info/camera_info"});
}

TEST_F(ReplayTest, WhereItIsInDoubtItListsWhatThereIs) {
  writeFrames(
      folder() + "/two.bag",
      [](rosbag::Bag& bag, const FakeCamera& camera, int frame, const ros::Time& arrival) {
        for (const std::string side : {"/left", "/right"}) {
          bag.write(side + "/rgb/camera_info", arrival, camera.info(frame));
          bag.write(side + "/rgb/image", arrival, *camera.colour(frame));
          bag.write(side + "/depth/image", arrival, *camera.depthImage(frame));
        }
      },
      0, 1);
  expectRefused("two.bag", {"2 topics have colour images: name one by --rgb TOPIC",
                            "/left/rgb/image: rgb8 of 320x240 px", "/right/rgb/image"});
  expectArguments(replay("two.bag --rgb /left/rgb/image --depth /left/depth/image"),
                  {"rgb_topic:=/left/rgb/image", "camera_info_topic:=/left/rgb/camera_info"});
}

TEST_F(ReplayTest, ABagThatBeginsIn1970IsRefusedOnlyWhereRosbagCannotSkipThat) {
  writeFrames(
      folder() + "/1970.bag",
      [](rosbag::Bag& bag, const FakeCamera& camera, int frame, const ros::Time&) {
        const ros::Time arrival(1'700'000'000.0);
        bag.write("/chatter", ros::Time(0, 1000), std_msgs::String());
        bag.write("/rgb/camera_info", arrival, camera.info(frame));
        bag.write("/rgb/image", arrival, *camera.colour(frame));
        bag.write("/depth/image", arrival, *camera.depthImage(frame));
      },
      0, 1);
  expectArguments(replay("1970.bag"), {"rgb_topic:=/rgb/image"});
  expectRefused("1970.bag rate:=0.5",
                {"1970.bag: begins 19675 days before its first image", "rosbag filter"});
  expectRefused("in.bag rate:=fast", {"rate:=fast", "expected a number above 0"});
}

TEST_F(ReplayTest, BagsAreNamedByTheirFullPaths) {
  fs::create_directories(folder() + "/it's in here");
  fs::copy_file(input(), folder() + "/it's in here/a b.bag", fs::copy_options::overwrite_existing);
  expectArguments(replay("in.bag \"it's in here/a b.bag\""),
                  {"bag:=" + input() + " " + folder() + "/it's in here/a b.bag"});
  expectArguments(replay("'~/in.bag'"), {"bag:=" + input()});
}

}  // namespace
}  // namespace rgbd_sfm_fusion
