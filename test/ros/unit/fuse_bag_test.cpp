// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// fuse_bag and tum_to_bag as users run them: what they leave behind, and what they say.
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "fake_camera.h"
#include "rgbd_sfm_fusion/FusionStatistics.h"
#include "rgbd_sfm_fusion/ros/bag_output.h"

namespace rgbd_sfm_fusion {
namespace {

namespace fs = std::filesystem;

constexpr int kFrames = 15;

struct Outcome {
  int status = -1;
  std::string output;  ///< stdout and stderr
};

Outcome runCommand(const std::string& command) {
  Outcome outcome;
  FILE* pipe = popen(("( " + command + " ) 2>&1").c_str(), "r");
  std::array<char, 4096> buffer{};
  while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) outcome.output += buffer.data();
  const int status = pclose(pipe);
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return outcome;
}

std::string content(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void writeBag(const std::string& path, const FakeCamera& camera, int frames) {
  BagOutput bag(path);
  for (int frame = 0; frame < frames; ++frame) {
    bag.write("/camera/rgb/camera_info", camera.info(frame));
    bag.write("/camera/rgb/image_raw", *camera.colour(frame));
    bag.write("/camera/depth_registered/image_raw", *camera.depthImage(frame));
  }
  bag.commit();
}

/// As recorded from a bag that is played again and again: arrival goes on, stamps do not.
void writeLoopedBag(const std::string& path, const FakeCamera& camera, int frames, int rounds) {
  rosbag::Bag bag(path, rosbag::bagmode::Write);
  for (int frame = 0; frame < frames; ++frame) {
    const sensor_msgs::ImagePtr colour = camera.colour(frame), depth = camera.depthImage(frame);
    for (int round = 0; round < rounds; ++round) {
      const ros::Time arrival(2000.0 + 0.033 * (frames * round + frame));
      bag.write("/camera/rgb/camera_info", arrival, camera.info(frame));
      bag.write("/camera/rgb/image_raw", arrival, *colour);
      bag.write("/camera/depth_registered/image_raw", arrival, *depth);
    }
  }
}

/// A folder with an input bag.
class FuseBagTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder() = ::testing::TempDir() + "fuse_bag_test." + std::to_string(getpid());
    fs::create_directories(folder());
    FakeCamera camera;
    camera.hole = 0.3F;
    writeBag(input(), camera, kFrames);
  }
  static void TearDownTestSuite() { fs::remove_all(folder()); }
  void TearDown() override { fs::remove_all(folder() + "/out"); }
  void SetUp() override { fs::create_directory(folder() + "/out"); }

  static std::string& folder() {
    static std::string folder;
    return folder;
  }
  static std::string input() { return folder() + "/in.bag"; }
  static std::string output() { return folder() + "/out/fused.bag"; }
  static std::string results() { return folder() + "/out/results"; }

  static Outcome fuse(const std::string& options, const std::string& bag = input(),
                      const std::string& before = "") {
    return runCommand(before + FUSE_BAG + " " + bag + " --output " + output() + " --results " + results() +
                      " " + options);
  }

  /// Neither under the final nor under the temporary names.
  static void expectNothingLeft() {
    for (const auto& entry : fs::recursive_directory_iterator(folder() + "/out")) {
      EXPECT_TRUE(entry.is_directory()) << entry.path();
    }
  }

  static void expectFailure(const Outcome& outcome, const std::string& message) {
    EXPECT_EQ(outcome.status, 1) << outcome.output;
    EXPECT_NE(outcome.output.find(message), std::string::npos) << outcome.output;
    expectNothingLeft();
  }
};

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
  const char* threads[] = {"1", "2", "2"};
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

TEST_F(FuseBagTest, BagsThatCannotBeReadAreSaidToBe) {
  expectFailure(fuse("", folder() + "/missing.bag"), "missing.bag");
  const std::string bytes = content(input());
  const std::string broken = folder() + "/broken.bag";
  for (const double share : {0.0, 0.3, 0.9, 0.999}) {
    const auto size = static_cast<std::size_t>(share * static_cast<double>(bytes.size()));
    std::ofstream(broken, std::ios::binary) << bytes.substr(0, size);
    expectFailure(fuse("", broken), "broken.bag: ");
  }
  std::ofstream(broken, std::ios::binary) << "this is no bag";
  expectFailure(fuse("", broken), "broken.bag: ");
}

TEST_F(FuseBagTest, ADamagedMessageEndsTheRunCleanly) {
  std::string bytes = content(input());
  const std::size_t middle = bytes.find("16UC1", bytes.size() / 2);
  ASSERT_NE(middle, std::string::npos);
  bytes.replace(middle, 5, "chess");
  std::ofstream(folder() + "/damaged.bag", std::ios::binary) << bytes;
  expectFailure(fuse("", folder() + "/damaged.bag"), "chess");
}

TEST_F(FuseBagTest, UncalibratedCamerasAreRefused) {
  BagOutput bag(folder() + "/uncalibrated.bag");
  const FakeCamera camera;
  sensor_msgs::CameraInfo info = camera.info(0);
  info.K[0] = info.P[0] = 0.0;
  bag.write("/camera/rgb/camera_info", info);
  bag.write("/camera/rgb/image_raw", *camera.colour(0));
  bag.write("/camera/depth_registered/image_raw", *camera.depthImage(0));
  bag.commit();
  expectFailure(fuse("", folder() + "/uncalibrated.bag"), "K[0]");
}

TEST_F(FuseBagTest, OutputsThatCannotBeWrittenAreNamedBeforeAnyWork) {
  const std::string command = std::string(FUSE_BAG) + " " + input();
  const Outcome bag = runCommand(command + " --output /missing/fused.bag --results " + results());
  expectFailure(bag, "cannot write /missing/fused.bag");
  const Outcome folder_is_a_file = runCommand(command + " --output " + output() + " --results " + input());
  EXPECT_EQ(folder_is_a_file.status, 1);
  EXPECT_NE(folder_is_a_file.output.find(input()), std::string::npos) << folder_is_a_file.output;
  expectNothingLeft();
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

TEST_F(FuseBagTest, AFullDiskLeavesNothingHalfWritten) {
  // A limit on the size of files fails as a full disk does, once its signal is ignored.
  for (const char* blocks : {"0", "8", "4000"}) {
    const Outcome outcome = fuse("", input(), std::string("trap '' XFSZ; ulimit -f ") + blocks + "; ");
    expectFailure(outcome, "cannot write ");
  }
}

TEST_F(FuseBagTest, CtrlCLeavesNothingHalfWritten) {
  FakeCamera camera;
  camera.colour_encoding = "mono8";
  writeLoopedBag(folder() + "/long.bag", camera, 20, 20);
  for (const char* signal : {"INT", "TERM"}) {
    const Outcome outcome =
        fuse("", folder() + "/long.bag", std::string("timeout --preserve-status -s ") + signal + " 0.7 ");
    EXPECT_EQ(outcome.status, 130) << outcome.output;
    EXPECT_NE(outcome.output.find("interrupted"), std::string::npos) << outcome.output;
    expectNothingLeft();
  }
}

TEST_F(FuseBagTest, StampsThatGoBackStartAnew) {
  const std::string path = folder() + "/looped.bag";
  writeLoopedBag(path, FakeCamera(), 8, 2);
  const Outcome outcome = fuse("", path);
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("stamps went back"), std::string::npos) << outcome.output;
  EXPECT_NE(outcome.output.find("16 frames: 16 tracked"), std::string::npos) << outcome.output;
}

TEST_F(FuseBagTest, WithoutAnyDepthItStillEnds) {
  BagOutput bag(folder() + "/no_depth.bag");
  FakeCamera camera;
  camera.hole = 1.0F;
  for (int frame = 0; frame < 5; ++frame) {
    bag.write("/camera/rgb/camera_info", camera.info(frame));
    bag.write("/camera/rgb/image_raw", *camera.colour(frame));
    bag.write("/camera/depth_registered/image_raw", *camera.depthImage(frame));
  }
  bag.commit();
  const Outcome outcome = fuse("", folder() + "/no_depth.bag");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("5 frames"), std::string::npos) << outcome.output;
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
