// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tools/pending_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <stdexcept>
#include "../temporary_path.h"

namespace rgbd_sfm_fusion {
namespace {

class PendingFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = temporaryPath("pending_file_test");
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

std::string errorOf(const std::function<void()>& function) {
  try {
    function();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST_F(PendingFileTest, NeverTouchesATemporaryFileThatIsThere) {
  const std::string path = folder_ + "/a.txt";
  std::ofstream(path + ".partial") << "of somebody";
  EXPECT_NE(errorOf([&] { PendingFile file(path); }).find(path + ".partial is there"), std::string::npos);
  EXPECT_EQ(content(path + ".partial"), "of somebody");
}

TEST_F(PendingFileTest, OfTwoTheSecondIsRefused) {
  const std::string path = folder_ + "/a.txt";
  PendingFile first(path);
  std::ofstream(first.temporaryPath()) << "first";
  EXPECT_NE(errorOf([&] { PendingFile second(path); }).find("it is being written already"),
            std::string::npos);
  first.commit();
  EXPECT_EQ(content(path), "first");
  EXPECT_EQ(errorOf([&] { PendingFile third(path); }), "");
}

TEST_F(PendingFileTest, WritesWhatASymbolicLinkNames) {
  std::filesystem::create_directory(folder_ + "/elsewhere");
  const std::string link = folder_ + "/link.txt", target = folder_ + "/elsewhere/a.txt";
  std::filesystem::create_symlink("elsewhere/a.txt", link);
  PendingFile file(link);
  std::ofstream(file.temporaryPath()) << "new";
  file.commit();
  EXPECT_EQ(content(target), "new");
  EXPECT_TRUE(std::filesystem::is_symlink(link));
}

TEST_F(PendingFileTest, AnInputIsRecognisedUnderAnyName) {
  const std::string input = folder_ + "/in.txt";
  std::ofstream(input) << "data";
  std::filesystem::create_symlink(input, folder_ + "/link.txt");
  std::filesystem::create_hard_link(input, folder_ + "/hard.txt");
  for (const std::string& output :
       {input, folder_ + "/./in.txt", folder_ + "/link.txt", folder_ + "/hard.txt"})
    EXPECT_NE(errorOf([&] {
                requireNoInput(output, {folder_ + "/other", input});
              }).find(input),
              std::string::npos);
  EXPECT_EQ(errorOf([&] { requireNoInput(folder_ + "/out.txt", {input}); }), "");
}

TEST_F(PendingFileTest, AFolderGoesUnlessItIsKeptOrWasThere) {
  using Existing = PendingFolder::Existing;
  const std::string made = folder_ + "/a/b/";
  { std::ofstream(PendingFolder(made, Existing::kRefuse).path() + "/x") << "half"; }
  EXPECT_FALSE(std::filesystem::exists(made));
  { std::ofstream(PendingFolder(made, Existing::kAccept).path() + "/x") << "of another"; }
  EXPECT_TRUE(std::filesystem::exists(made + "x")) << "it was not empty";
  EXPECT_NE(errorOf([&] { PendingFolder folder(made, Existing::kRefuse); }).find("it is there already"),
            std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(made + "x"));
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
