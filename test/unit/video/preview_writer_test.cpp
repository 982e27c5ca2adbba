// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/video/preview_writer.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include "../temporary_path.h"

namespace rgbd_sfm_fusion {
namespace {

namespace fs = std::filesystem;

const cv::Size kSize(64, 48);

class PreviewWriterTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = temporaryPath("preview_writer_test");
    fs::remove_all(folder_);
    fs::create_directory(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// Writes pictures at 10 Hz, each redder than the one before.
  static void writeFrames(PreviewWriter& writer, int count) {
    for (int i = 0; i < count; ++i) {
      const cv::Mat_<cv::Vec3b> rgb(kSize, cv::Vec3b(static_cast<std::uint8_t>(100 + 5 * i), 0, 0));
      writer.write(Stamp{i} * 100'000'000, rgb);
    }
  }

  std::size_t filesIn(const std::string& folder) const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
  }

  void expectError(const std::string& path, const std::string& reason) {
    try {
      PreviewWriter writer(path, kSize);
      ADD_FAILURE() << path;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
    }
  }

  std::string folder_;
};

TEST_F(PreviewWriterTest, AnAviIsAVideoOfTheFramesRate) {
  for (const int frames : {3, 25}) {  // fewer and more than it takes to learn the rate
    const std::string path = folder_ + "/a.avi";
    PreviewWriter writer(path, kSize);
    ASSERT_FALSE(writer.usedFolderInstead());
    writeFrames(writer, frames);
    EXPECT_EQ(fs::exists(path), frames == 25) << "an earlier one stays until the new one is complete";
    writer.finish();
    writer.commit();
    EXPECT_EQ(filesIn(folder_), 1U);
    cv::VideoCapture video(path);
    EXPECT_NEAR(video.get(cv::CAP_PROP_FPS), 10.0, 1e-6);
    int read = 0;
    for (cv::Mat bgr; video.read(bgr); ++read) {
      ASSERT_EQ(bgr.size(), kSize);
      EXPECT_NEAR(bgr.at<cv::Vec3b>(20, 30)[2], 100 + 5 * read, 12);
      EXPECT_LT(bgr.at<cv::Vec3b>(20, 30)[0], 40) << "blue";
    }
    EXPECT_EQ(read, frames);
  }
}

TEST_F(PreviewWriterTest, AnyOtherNameIsAFolderOfPictures) {
  const std::string path = folder_ + "/frames";
  PreviewWriter writer(path + "/", kSize);
  writeFrames(writer, 3);
  EXPECT_FALSE(fs::exists(path));
  writer.finish();
  writer.commit();
  EXPECT_EQ(filesIn(folder_), 1U);
  EXPECT_EQ(filesIn(path), 3U);
  EXPECT_EQ(cv::imread(path + "/000002.png").at<cv::Vec3b>(0, 0), cv::Vec3b(0, 0, 110));
}

TEST_F(PreviewWriterTest, ReplacesAnEarlierPreviewAsAWhole) {
  const std::string path = folder_ + "/frames";
  for (const int frames : {5, 2}) {
    PreviewWriter writer(path, kSize);
    writeFrames(writer, frames);
    writer.finish();
    writer.commit();
    EXPECT_EQ(filesIn(path), static_cast<std::size_t>(frames));
  }
}

TEST_F(PreviewWriterTest, LeavesNothingWhenNotCommitted) {
  for (const char* name : {"/a.avi", "/frames"}) {
    {
      PreviewWriter writer(folder_ + name, kSize);
      writeFrames(writer, 12);
    }
    EXPECT_EQ(filesIn(folder_), 0U) << name;
  }
}

TEST_F(PreviewWriterTest, SaysWhatCannotBeWritten) {
  fs::create_directory(folder_ + "/mine");
  std::ofstream(folder_ + "/mine/letter.txt") << "dear";
  std::ofstream(folder_ + "/file") << "x";
  expectError(folder_ + "/mine", "other files");
  expectError(folder_ + "/file", "it is a file");
  expectError(folder_ + "/missing/a.avi", "No such file");
  expectError(folder_ + "/missing/frames", "No such file");
  EXPECT_TRUE(fs::exists(folder_ + "/mine/letter.txt"));
}

TEST_F(PreviewWriterTest, AFullDiskIsNoticed) {
  rlimit before{}, small{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);  // then a limit on files fails as a full disk does
  for (const char* name : {"/a.avi", "/frames"}) {
    PreviewWriter writer(folder_ + name, kSize);
    small = before;
    small.rlim_cur = 500;  // [bytes] less than half a picture
    setrlimit(RLIMIT_FSIZE, &small);
    const auto writeAll = [&] {
      for (int i = 0; i < 30; ++i) {
        cv::Mat_<cv::Vec3b> noise(kSize);
        cv::randu(noise, cv::Scalar::all(0), cv::Scalar::all(256));
        writer.write(Stamp{i} * 100'000'000, noise);
      }
      writer.finish();
      writer.commit();
    };
    EXPECT_THROW(writeAll(), std::runtime_error) << name;
    setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_FALSE(fs::exists(folder_ + name));
  }
  std::signal(SIGXFSZ, handler);
}

TEST(VideoRate, IsTheMediansOfTheTimesBetweenFrames) {
  EXPECT_EQ(videoRate({0, 100, 200'000'000}), 5.0) << "0.2 s, of two times";
  EXPECT_EQ(videoRate({0, 33'400'000, 66'700'000, 100'000'000, 900'000'000}), 29.9);
  EXPECT_EQ(videoRate({5}), 30.0);
  EXPECT_EQ(videoRate({5, 5, 4}), 30.0);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
