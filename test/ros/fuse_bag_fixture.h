// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "fake_camera.h"
#include "rgbd_sfm_fusion/ros/bag_output.h"

namespace rgbd_sfm_fusion {

namespace fs = std::filesystem;

constexpr int kFrames = 15;

struct Outcome {
  int status = -1;
  std::string output;  ///< stdout and stderr
};

inline Outcome runCommand(const std::string& command) {
  Outcome outcome;
  FILE* pipe = popen(("( " + command + " ) 2>&1").c_str(), "r");
  std::array<char, 4096> buffer{};
  while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) outcome.output += buffer.data();
  const int status = pclose(pipe);
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return outcome;
}

inline std::string content(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline std::vector<std::string> lines(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> result;
  for (std::string line; std::getline(stream, line);) result.push_back(line);
  return result;
}

/// Cells of a row of a table.
inline std::vector<std::string> cells(const std::string& row) {
  std::vector<std::string> result;
  std::istringstream text(row);
  for (std::string cell; std::getline(text, cell, ',');) result.push_back(cell);
  return result;
}

inline void writeBag(const std::string& path, const FakeCamera& camera, int frames) {
  BagOutput bag(path);
  for (int frame = 0; frame < frames; ++frame) {
    bag.write("/camera/rgb/camera_info", camera.info(frame));
    bag.write("/camera/rgb/image_raw", *camera.colour(frame));
    bag.write("/camera/depth_registered/image_raw", *camera.depthImage(frame));
  }
  bag.commit();
}

/// Writes a frame into a bag, under names of its choice.
using WriteFrame = std::function<void(rosbag::Bag&, const FakeCamera&, int frame, const ros::Time& arrival)>;

/// @return the path
inline std::string writeFrames(const std::string& path, const WriteFrame& write, int first = 0,
                               int end = kFrames) {
  FakeCamera camera;
  camera.hole = 0.3F;
  rosbag::Bag bag(path, rosbag::bagmode::Write);
  for (int frame = first; frame < end; ++frame) write(bag, camera, frame, toRosTime(camera.stamp(frame)));
  return path;
}

/// Like a recording of a bag that is played again and again: times of arrival go on, stamps begin anew.
inline void writeLoopedBag(const std::string& path, const FakeCamera& camera, int frames, int rounds) {
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

  /// Expects no file, neither under the final nor under the temporary names.
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

}  // namespace rgbd_sfm_fusion
