// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tools/pending_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace rgbd_sfm_fusion {
namespace {

class PendingFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = ::testing::TempDir() + "pending_file_test";
    std::filesystem::create_directory(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static std::string content(const std::string& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  std::string folder_;
};

TEST_F(PendingFileTest, AppearsWithItsContentWhenCommitted) {
  const std::string path = folder_ + "/a.txt";
  PendingFile file(path);
  std::ofstream(file.temporaryPath()) << "new";
  EXPECT_FALSE(std::filesystem::exists(path));
  file.commit();
  EXPECT_EQ(content(path), "new");
  EXPECT_FALSE(std::filesystem::exists(file.temporaryPath()));
}

TEST_F(PendingFileTest, LeavesWhatWasThereWhenNotCommitted) {
  const std::string path = folder_ + "/a.txt";
  std::ofstream(path) << "old";
  { std::ofstream(PendingFile(path).temporaryPath()) << "half"; }
  EXPECT_EQ(content(path), "old");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

TEST_F(PendingFileTest, SaysWhichPathCannotBeWritten) {
  for (const std::string& path : {folder_, folder_ + "/missing/a.txt", std::string("/dev/null/a")}) {
    try {
      PendingFile file(path);
      ADD_FAILURE() << path;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
