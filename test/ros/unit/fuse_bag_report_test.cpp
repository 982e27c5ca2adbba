// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// fuse_bag's page of a run, the settings that it lists, and compressed bags.
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "fuse_bag_fixture.h"

namespace rgbd_sfm_fusion {
namespace {

bool mentions(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::string page() {
  return ::testing::TempDir() + "fuse_bag_test." + std::to_string(getpid()) + "/out/page.html";
}

TEST_F(FuseBagTest, APageIsMadeWhenTheRunIsComplete) {
  const Outcome outcome = fuse("--set noise_lateral=0.25 --report " + page());
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_TRUE(mentions(outcome.output, "refilled")) << outcome.output;
  const std::string html = content(page());
  EXPECT_TRUE(mentions(html, "</html>"));
  EXPECT_TRUE(mentions(html, "in.bag"));
  EXPECT_TRUE(mentions(html, "noise_lateral")) << "a setting that is not the default";
  EXPECT_TRUE(mentions(html, "SfM depth")) << "it is in the bag";
}

TEST_F(FuseBagTest, ThePageMayGoIntoTheResultsFolder) {
  const Outcome outcome = fuse("--report " + results() + "/report.html");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_TRUE(fs::exists(results() + "/report.html"));
}

TEST_F(FuseBagTest, WhatThePageNeedsIsMissedBeforeTheRun) {
  const std::string modules = folder() + "/modules";
  fs::create_directories(modules);
  std::ofstream(modules + "/matplotlib.py") << "raise ImportError('none here')\n";
  const Outcome outcome = fuse("--report " + page(), input(), "PYTHONPATH=" + modules + ":$PYTHONPATH ");
  expectFailure(outcome, "python3-matplotlib is missing");
  EXPECT_TRUE(mentions(outcome.output, "apt-get install python3-matplotlib")) << outcome.output;
  EXPECT_FALSE(mentions(outcome.output, "frames:")) << "said before the run";
  expectFailure(fuse("--report /missing/page.html"), "there is no folder /missing");
  expectFailure(fuse("--report " + page() + " --truth " + folder()), "has no groundtruth.txt");
}

TEST_F(FuseBagTest, ThePageIsNeitherInputNorOutput) {
  expectFailure(fuse("--report " + input()), "that would destroy the input");
  expectFailure(fuse("--report " + output()), "are the same file");
}

TEST_F(FuseBagTest, SettingsOfARunGiveTheSameRunAgain) {
  ASSERT_EQ(fuse("--set sensor=astra --set max_range=4 --set threads=1").status, 0);
  const std::string bag = content(output()), settings = content(results() + "/settings.yaml");
  EXPECT_TRUE(mentions(settings, "max_range: 4\n")) << settings;
  EXPECT_FALSE(mentions(settings, "threads")) << "makes no difference";
  const std::string file = folder() + "/of_before.yaml";
  std::ofstream(file) << settings;
  ASSERT_EQ(fuse("--config " + file).status, 0);
  EXPECT_TRUE(content(output()) == bag);
  EXPECT_EQ(content(results() + "/settings.yaml"), settings);
}

TEST_F(FuseBagTest, SettingsComeFromSeveralFiles) {
  const std::string one = folder() + "/one.yaml", two = folder() + "/two.yaml";
  std::ofstream(one) << "max_range: 4\nrim_width: 2\n";
  std::ofstream(two) << "sensor: astra\nrim_width: 1\n";
  // Each option takes one file: the word after it is not another file.
  const Outcome outcome = runCommand(std::string(FUSE_BAG) + " --output " + output() + " --results " +
                                     results() + " --config " + one + " --config " + two + " " + input());
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  const std::string settings = content(results() + "/settings.yaml");
  EXPECT_TRUE(mentions(settings, "sensor: astra\n")) << settings;
  EXPECT_TRUE(mentions(settings, "max_range: 4\n")) << settings;
  EXPECT_TRUE(mentions(settings, "rim_width: 1\n")) << settings;
}

TEST_F(FuseBagTest, TheSummarySaysWhatWasReadAndChanged) {
  ASSERT_EQ(fuse("--start 0.1 --set max_range=4").status, 0);
  const std::string summary = content(results() + "/summary.json");
  EXPECT_TRUE(mentions(summary, "\"bags\": [\"" + input() + "\"]")) << summary;
  EXPECT_TRUE(mentions(summary, "\"depth\": \"/camera/depth_registered/image_raw\"")) << summary;
  EXPECT_TRUE(mentions(summary, "\"start\": 0.100")) << summary;
  EXPECT_TRUE(mentions(summary, "\"changed_settings\": {\n    \"max_range\": 5\n  }")) << summary;
}

TEST_F(FuseBagTest, CompressedBagsHoldTheSame) {
  std::map<std::string, std::vector<std::string>> messages;
  std::map<std::string, std::uintmax_t> sizes;
  for (const std::string compression : {"none", "lz4", "bz2"}) {
    const Outcome outcome = fuse("--compress " + compression);
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    sizes[compression] = fs::file_size(output());
    rosbag::Bag bag(output());
    for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
      std::vector<std::uint8_t> bytes(message.size());
      ros::serialization::OStream stream(bytes.data(), message.size());
      message.write(stream);
      messages[compression].push_back(message.getTopic() + std::string(bytes.begin(), bytes.end()));
    }
  }
  EXPECT_TRUE(messages["none"] == messages["lz4"]);
  EXPECT_TRUE(messages["none"] == messages["bz2"]);
  EXPECT_LT(sizes["lz4"], sizes["none"]);
  EXPECT_LT(sizes["bz2"], sizes["lz4"]);
  TearDown(), SetUp();
  const Outcome refused = fuse("--compress zip");
  EXPECT_EQ(refused.status, 105) << refused.output;  // CLI11's ValidationError, as for other options
  EXPECT_TRUE(mentions(refused.output, "--compress: zip not in {none,lz4,bz2}")) << refused.output;
  expectNothingLeft();
}

}  // namespace
}  // namespace rgbd_sfm_fusion
