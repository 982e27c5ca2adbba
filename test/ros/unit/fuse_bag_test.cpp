// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// fuse_bag and tum_to_bag as users run them, and their results.
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "fake_camera.h"
#include "fuse_bag_fixture.h"
#include "rgbd_sfm_fusion/FusionStatistics.h"

namespace rgbd_sfm_fusion {
namespace {

TEST_F(FuseBagTest, WritesWhatTheContractSays) {
  const Outcome outcome = fuse("--topics /fusion/sfm_depth /tracker/keyframe");
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  std::map<std::string, std::size_t> messages;
  rosbag::Bag bag(output());
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
    ++messages[message.getTopic()];
    EXPECT_FALSE(message.getTime().isZero());
  }
  for (const char* topic :
       {"/fusion/mean", "/fusion/variance", "/fusion/provenance", "/fusion/scale", "/fusion/statistics",
        "/fusion/camera_info", "/fusion/sfm_depth", "/tracker/pose", "/tracker/frame", "/tracker/keyframe"}) {
    EXPECT_EQ(messages[topic], static_cast<std::size_t>(kFrames)) << topic;
  }
  EXPECT_EQ(messages.size(), 10U);
  for (const char* file : {"trajectory.txt", "frames.csv", "keyframes.csv", "timing.csv", "summary.json"}) {
    EXPECT_GT(fs::file_size(results() + "/" + file), 0U) << file;
  }
  const std::string trajectory = content(results() + "/trajectory.txt");
  EXPECT_EQ(std::count(trajectory.begin(), trajectory.end(), '\n'), kFrames + 1)
      << "one line per tracked frame";
  EXPECT_NE(trajectory.find("\n1000.000000000 0.000000000 0.000000000 0.000000000 0.0"), std::string::npos);
  EXPECT_NE(content(results() + "/summary.json").find("\"frames_tracked\": 15"), std::string::npos);
}

TEST_F(FuseBagTest, IsTheSameForAnyNumberOfThreads) {
  std::map<std::string, std::string> files[3];
  const char* threads[] = {"1", "2", "3"};
  for (int run = 0; run < 3; ++run) {
    ASSERT_EQ(fuse(std::string("--set threads=") + threads[run]).status, 0);
    for (const std::string file : {"trajectory.txt", "frames.csv", "keyframes.csv"}) {
      files[run][file] = content(results() + "/" + file);
    }
    files[run]["bag"] = content(output());
  }
  for (const auto& [name, bytes] : files[0]) {
    EXPECT_TRUE(bytes == files[1][name]) << name << ": 1 and 2 threads";
    EXPECT_TRUE(bytes == files[2][name]) << name << ": twice the same";
  }
}

TEST_F(FuseBagTest, TakesAPartOfTheBag) {
  ASSERT_EQ(fuse("--start 0.1 --duration 0.1").status, 0);
  rosbag::Bag bag(output());
  rosbag::View view(bag, rosbag::TopicQuery("/fusion/mean"));
  EXPECT_GE(view.getBeginTime(), ros::Time(1000.099));
  EXPECT_LE(view.getEndTime(), ros::Time(1000.201));
  EXPECT_GE(view.size(), 3U);
  TearDown(), SetUp();
  expectFailure(fuse("--start 100"), "no image of /camera/rgb/image_raw in that time");
}

TEST_F(FuseBagTest, SettingsThatAreNoneAreExplained) {
  expectFailure(fuse("--set sensor_feedbak=on"), "did you mean 'sensor_feedback'?");
  expectFailure(fuse("--set max_range=1000"), "max_range = 1000: expected 0.1 to 100 m");
  expectFailure(fuse("--config " + folder() + "/missing.yaml"), "missing.yaml");
  expectFailure(fuse("--topics /fusion/menu"), "/fusion/mean");
}

TEST_F(FuseBagTest, ABagWithoutTheTopicsListsThoseItHas) {
  const Outcome outcome = fuse("--rgb /other/image_raw");
  expectFailure(outcome, "no topic /other/image_raw of type sensor_msgs/Image");
  EXPECT_NE(outcome.output.find("/camera/rgb/image_raw (sensor_msgs/Image)"), std::string::npos);
  expectFailure(fuse("--rgb /camera/rgb/camera_info"), "of type sensor_msgs/Image");
  expectFailure(fuse("--camera-info /none"), "no topic /none");
}

TEST_F(FuseBagTest, PreviewIsAVideoOrAFolderAndDoesNotChangeTheResults) {
  const Outcome plain = fuse("");
  ASSERT_EQ(plain.status, 0) << plain.output;
  const std::string without = content(output());
  const std::string video = folder() + "/out/preview.avi", pictures = folder() + "/out/preview";
  for (const std::string& path : {video, pictures}) {
    const Outcome outcome = fuse("--preview " + path);
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_EQ(content(output()), without);
  }
  EXPECT_GT(fs::file_size(video), 10'000U);
  EXPECT_EQ(std::distance(fs::directory_iterator(pictures), {}), kFrames);
  const std::string last = content(pictures + "/000014.png");
  ASSERT_EQ(fuse("--set threads=1 --preview " + pictures).status, 0);
  EXPECT_EQ(content(pictures + "/000014.png"), last) << "with any number of threads";
}

TEST_F(FuseBagTest, APreviewThatCannotBeWrittenLeavesNothing) {
  expectFailure(fuse("--preview " + folder() + "/missing/preview.avi"), "missing/preview.avi");
  expectFailure(fuse("--preview " + folder()), "other files");
}

TEST_F(FuseBagTest, TheImageAndThePointsCanBeWrittenToo) {
  ASSERT_EQ(fuse("--topics /fusion/image_rect /fusion/points").status, 0);
  std::map<std::string, std::size_t> messages;
  rosbag::Bag bag(output());
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) ++messages[message.getTopic()];
  EXPECT_EQ(messages["/fusion/image_rect"], static_cast<std::size_t>(kFrames));
  EXPECT_EQ(messages["/fusion/points"], static_cast<std::size_t>(kFrames));
}

TEST_F(FuseBagTest, StampsThatGoBackStartAnew) {
  const std::string path = folder() + "/looped.bag";
  writeLoopedBag(path, FakeCamera(), 8, 2);
  const Outcome outcome = fuse("", path);
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("stamps went back"), std::string::npos) << outcome.output;
  EXPECT_NE(outcome.output.find("16 frames: 16 tracked"), std::string::npos) << outcome.output;

  const std::vector<std::string> trajectory = lines(content(results() + "/trajectory.txt"));
  ASSERT_EQ(trajectory.size(), 1U + 8U + 1U + 8U);
  EXPECT_EQ(trajectory[9].rfind("# run 2 starts here: ", 0), 0U) << trajectory[9];
  EXPECT_EQ(trajectory[10], trajectory[1]) << "the same images again";
  for (const char* file : {"/frames.csv", "/keyframes.csv"}) {
    const std::vector<std::string> rows = lines(content(results() + file));
    ASSERT_EQ(rows.size() % 2, 1U) << "a header and two runs of the same images: " << file;
    const std::vector<std::string> header = cells(rows[0]);
    const auto run =
        static_cast<std::size_t>(std::find(header.begin(), header.end(), "run") - header.begin());
    ASSERT_LT(run, header.size()) << rows[0];
    for (std::size_t i = 1; i < rows.size(); ++i)
      EXPECT_EQ(cells(rows[i]).at(run), i <= rows.size() / 2 ? "1" : "2") << file << " " << rows[i];
  }
}

TEST_F(FuseBagTest, TumToBagSaysWhatIsMissing) {
  const auto convert = [](const std::string& arguments) { return runCommand(TUM_TO_BAG " " + arguments); };
  Outcome outcome = convert(folder() + " " + output());
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.output.find("calib.txt"), std::string::npos) << outcome.output;
  std::ofstream(folder() + "/calib.txt") << "500 500 320 240 640 480 1000\n";
  std::ofstream(folder() + "/associations.txt") << "1.0 rgb/1.jpg 1.0 depth/1.png\n";
  outcome = convert(folder() + " " + output());
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.output.find("1."), std::string::npos) << outcome.output;
  expectNothingLeft();
  outcome = convert(folder() + " " + output() + " --start 5");
  EXPECT_NE(outcome.output.find("only 1 frames"), std::string::npos) << outcome.output;
}

}  // namespace
}  // namespace rgbd_sfm_fusion
