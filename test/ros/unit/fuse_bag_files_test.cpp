// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// fuse_bag and tum_to_bag with files that are missing, are something else, or belong to somebody else.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "fake_camera.h"
#include "fuse_bag_fixture.h"
#include "rgbd_sfm_fusion/tools/bag_file.h"

namespace rgbd_sfm_fusion {
namespace {

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

TEST_F(FuseBagTest, OutputsThatCannotBeWrittenAreNamedBeforeAnyWork) {
  const std::string command = std::string(FUSE_BAG) + " " + input();
  const Outcome bag = runCommand(command + " --output /missing/fused.bag --results " + results());
  expectFailure(bag, "cannot write /missing/fused.bag");
  const Outcome folder_is_a_file = runCommand(command + " --output " + output() + " --results " + input());
  EXPECT_EQ(folder_is_a_file.status, 1);
  EXPECT_NE(folder_is_a_file.output.find(input()), std::string::npos) << folder_is_a_file.output;
  expectNothingLeft();
}

TEST_F(FuseBagTest, AFullDiskLeavesNothingHalfWritten) {
  // Writing beyond a limit on the size of files fails as on a full disk. By default, a signal kills as well.
  for (const char* blocks : {"0", "8", "4000"}) {
    for (const char* trap : {"", "trap '' XFSZ; "}) {
      const Outcome outcome = fuse("", input(), std::string(trap) + "ulimit -f " + blocks + "; ");
      expectFailure(outcome, "cannot write ");
      EXPECT_FALSE(fs::exists(results())) << "a folder that was made for nothing";
    }
  }
}

TEST_F(FuseBagTest, SignalsLeaveNothingHalfWritten) {
  FakeCamera camera;
  camera.colour_encoding = "mono8";
  writeLoopedBag(folder() + "/long.bag", camera, 20, 20);
  std::string long_enough;  // for the signal to come before the end
  for (int i = 0; i < 30; ++i) long_enough += " " + folder() + "/long.bag";
  for (const std::string signal : {"INT", "TERM", "HUP"}) {
    const Outcome outcome =
        runCommand(std::string(FUSE_BAG) + long_enough + " --output " + output() + " --results " + results() +
                   " & while [ ! -e " + results() + "/summary.json.partial ]; do sleep 0.01; done; kill -s " +
                   signal + " $!; wait $!");
    EXPECT_EQ(outcome.status, 130) << outcome.output;
    EXPECT_NE(outcome.output.find("interrupted"), std::string::npos) << outcome.output;
    expectNothingLeft();
  }
}

TEST_F(FuseBagTest, TheInputIsNeverTheOutput) {
  const std::string before = content(input());
  const std::string link = folder() + "/link.bag", hard_link = folder() + "/hard_link.bag";
  const std::string partial = folder() + "/x.bag.partial", config = folder() + "/settings.yaml";
  fs::create_symlink(input(), link);
  fs::create_hard_link(input(), hard_link);
  fs::copy_file(input(), partial);
  std::ofstream(config) << "max_range: 4\n";
  fs::create_directory(folder() + "/named");
  fs::create_symlink(input(), folder() + "/named/frames.csv");
  const auto refused = [&](const std::string& arguments) {
    expectFailure(runCommand(std::string(FUSE_BAG) + " " + arguments), "that would destroy the input ");
    EXPECT_TRUE(content(input()) == before) << arguments;
  };
  refused(input() + " --output " + input() + " --results " + results());
  refused(input() + " --output " + link + " --results " + results());
  refused(input() + " --output " + hard_link + " --results " + results());
  refused(link + " --output " + input() + " --results " + results());
  refused(partial + " --output " + folder() + "/x.bag --results " + results());
  EXPECT_TRUE(content(partial) == before);
  refused(input() + " --output " + output() + " --results " + folder() + "/named");
  refused(input() + " --config " + config + " --output " + config + " --results " + results());
  EXPECT_EQ(content(config), "max_range: 4\n");
}

TEST_F(FuseBagTest, OnlyFilesAreWritten) {
  const std::string pipe = folder() + "/pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const auto refused = [&](const std::string& path, const std::string& reason) {
    expectFailure(
        runCommand(std::string(FUSE_BAG) + " " + input() + " --output " + path + " --results " + results()),
        "cannot write " + path + ": " + reason);
  };
  refused(pipe, "it is a device or a pipe");
  refused(folder(), "it is a folder");
  EXPECT_TRUE(fs::is_fifo(pipe));
}

TEST_F(FuseBagTest, TwoRunsIntoOneOutputAreRefused) {
  std::ofstream(output() + ".partial") << "of somebody";
  const Outcome left_over = fuse("");
  EXPECT_EQ(left_over.status, 1);
  EXPECT_NE(left_over.output.find("fused.bag.partial is there"), std::string::npos) << left_over.output;
  EXPECT_EQ(content(output() + ".partial"), "of somebody");
  fs::remove(output() + ".partial");

  FakeCamera camera;
  camera.colour_encoding = "mono8";
  writeLoopedBag(folder() + "/long.bag", camera, 20, 4);
  const std::string command =
      std::string(FUSE_BAG) + " " + folder() + "/long.bag --output " + output() + " --results " + results();
  const Outcome two =
      runCommand(command + " > /dev/null & while [ ! -e " + output() + ".partial ]; do sleep 0.01; done; " +
                 command + "; echo second $?; wait $!; echo first $?");
  EXPECT_NE(two.output.find("it is being written already"), std::string::npos) << two.output;
  EXPECT_NE(two.output.find("second 1"), std::string::npos) << two.output;
  EXPECT_NE(two.output.find("first 0"), std::string::npos) << two.output;
  EXPECT_EQ(BagFile(output()).connections().size(), 8U) << "a whole bag";
}

TEST_F(FuseBagTest, OfABagThatCannotBeOpenedItIsSaidWhy) {
  const std::string missing = folder() + "/missing.bag", pipe = folder() + "/pipe.bag";
  expectFailure(fuse("", missing), missing + ": there is no such file");
  expectFailure(fuse("", folder()), folder() + ": is a folder");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  expectFailure(fuse("", pipe), pipe + ": is a device or a pipe");
  fs::copy_file(input(), missing + ".active");
  expectFailure(fuse("", missing), "there is " + missing + ".active");
  fs::remove(missing + ".active");
}

TEST_F(FuseBagTest, ARecordingThatWasCutOffIsRecognised) {
  const std::string bytes = content(input()), active = folder() + "/rec.bag.active";
  for (const std::size_t size : {4096U, 4117U, 100000U}) {
    std::string cut = bytes.substr(0, size);
    cut.replace(bytes.find("index_pos=") + 10, 8, 8, '\0');  // as in a bag that is still being recorded
    std::ofstream(active, std::ios::binary) << cut;
    const Outcome outcome = fuse("", active);
    expectFailure(outcome, "is a recording that was cut off");
    const std::string cure =
        size == 4096U ? "nothing is in it that could be repaired" : "rosbag reindex " + active;
    EXPECT_NE(outcome.output.find(cure), std::string::npos) << outcome.output;
  }
  std::ofstream(active, std::ios::binary) << "";
  expectFailure(fuse("", active), "is empty: the recording was cut off before anything came");
}

TEST_F(FuseBagTest, TumToBagWritesOverNothingThatItReads) {
  const std::string sequence = folder() + "/sequence";
  fs::create_directories(sequence + "/rgb");
  std::ofstream(sequence + "/calib.txt") << "500 500 320 240 640 480 1000\n";
  std::ofstream(sequence + "/associations.txt") << "1.0 rgb/1.png 1.0 depth/1.png\n";
  std::ofstream(sequence + "/rgb/1.png") << "an image";
  for (const std::string name : {"calib.txt", "associations.txt", "rgb/1.png"}) {
    const std::string before = content(sequence + "/" + name);
    const Outcome outcome =
        runCommand(std::string(TUM_TO_BAG) + " " + sequence + " " + sequence + "/" + name);
    expectFailure(outcome, "that would destroy the input");
    EXPECT_EQ(content(sequence + "/" + name), before);
  }
}

TEST_F(FuseBagTest, TumToBagLeavesNothingHalfWritten) {
  const std::string sequence = folder() + "/long_sequence";
  fs::create_directory(sequence);
  std::ofstream(sequence + "/calib.txt") << "500 500 320 240 640 480 1000\n";
  ASSERT_TRUE(cv::imwrite(sequence + "/rgb.png", cv::Mat(480, 640, CV_8UC3, cv::Scalar(90))));
  ASSERT_TRUE(cv::imwrite(sequence + "/depth.png", cv::Mat(480, 640, CV_16UC1, cv::Scalar(900))));
  std::ofstream associations(sequence + "/associations.txt");
  for (int i = 1; i <= 400; ++i) associations << i << " rgb.png " << i << " depth.png\n";
  associations.close();
  const std::string command = std::string(TUM_TO_BAG) + " " + sequence + " " + output();
  expectFailure(runCommand("ulimit -f 4000; " + command), "cannot write ");
  for (const std::string signal : {"INT", "TERM"}) {
    const Outcome outcome = runCommand(command + " & while [ ! -e " + output() +
                                       ".partial ]; do sleep 0.01; done; kill -s " + signal + " $!; wait $!");
    EXPECT_EQ(outcome.status, 130) << outcome.output;
    expectNothingLeft();
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
