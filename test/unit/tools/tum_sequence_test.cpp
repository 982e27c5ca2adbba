// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tools/tum_sequence.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace rgbd_sfm_fusion {
namespace {

class TumSequenceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = ::testing::TempDir() + "tum_sequence_test";
    std::filesystem::create_directory(folder_);
    write("calib.txt", "# fx fy …\n500 501.5 319.5 239.5 640 480 5000\n# dist 0.1 -0.2 0.3 -0.4 0.5\n");
    write("associations.txt",
          "# comment\n1.5 rgb/a.jpg 1.25 depth/a.png\n\n2 rgb/b.jpg 2.000000001 depth/b.png\n");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ + "/" + name) << text;
  }

  std::string error() const {
    try {
      readTumSequence(folder_);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  std::string folder_;
};

TEST_F(TumSequenceTest, ReadsCalibrationAndPairs) {
  const TumSequence sequence = readTumSequence(folder_);
  EXPECT_EQ(sequence.fy, 501.5);
  EXPECT_EQ(sequence.width, 640);
  EXPECT_EQ(sequence.depth_scale, 5000.0);
  EXPECT_EQ(sequence.distortion, (std::array<double, 5>{0.1, -0.2, 0.3, -0.4, 0.5}));
  ASSERT_EQ(sequence.pairs.size(), 2U);
  EXPECT_EQ(sequence.pairs[0].rgb_stamp, 1'500'000'000);
  EXPECT_EQ(sequence.pairs[1].depth_stamp, 2'000'000'001);
  EXPECT_EQ(sequence.pairs[1].depth_path, folder_ + "/depth/b.png");
}

TEST_F(TumSequenceTest, HasNoDistortionWithoutThatLine) {
  write("calib.txt", "500 500 320 240 640 480 1000\n");
  EXPECT_EQ(readTumSequence(folder_).distortion, (std::array<double, 5>{}));
}

TEST_F(TumSequenceTest, NamesTheFileThatIsMissing) {
  std::filesystem::remove(folder_ + "/associations.txt");
  EXPECT_NE(error().find("associations.txt"), std::string::npos);
  std::filesystem::remove(folder_ + "/calib.txt");
  EXPECT_NE(error().find("calib.txt"), std::string::npos);
}

TEST_F(TumSequenceTest, NamesTheLineThatIsWrong) {
  write("associations.txt", "1.5 rgb/a.jpg 1.25 depth/a.png\n1.6 rgb/b.jpg\n");
  EXPECT_NE(error().find("associations.txt, line 2"), std::string::npos) << error();
  write("calib.txt", "500 500 320 240 640 480\n");
  EXPECT_NE(error().find("calib.txt, line 1"), std::string::npos) << error();
  write("calib.txt", "500 500 320 240 640 480 0\n");
  EXPECT_NE(error().find("calib.txt, line 1"), std::string::npos) << error();
  write("calib.txt", "500 500 320 240 640 480 1000\n# dist 1 2\n");
  EXPECT_NE(error().find("calib.txt, line 2"), std::string::npos) << error();
}

TEST(ParseStamp, IsExactWhereADoubleIsNot) {
  EXPECT_EQ(parseStamp("1305031102.175304"), 1305031102175304000);
  EXPECT_EQ(parseStamp("1305031102.175304001"), 1305031102175304001);
  EXPECT_EQ(parseStamp("4294967295.999999999"), 4294967295999999999);
  EXPECT_EQ(parseStamp("0"), 0);
  EXPECT_EQ(parseStamp("7."), 7'000'000'000);
}

TEST(ParseStamp, RefusesWhatIsNoTime) {
  for (const char* text :
       {"", ".", ".5", "-1", "1e9", "1.2.3", "nan", "1 ", "4294967296", "99999999999", "0x10"}) {
    EXPECT_THROW(parseStamp(text), std::runtime_error) << text;
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
