// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tools/tum_sequence.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include "../temporary_path.h"

namespace rgbd_sfm_fusion {
namespace {

class TumSequenceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = temporaryPath("tum_sequence_test");
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

TEST_F(TumSequenceTest, AnArchiveIsAssociated) {
  std::filesystem::remove(folder_ + "/associations.txt");
  write("rgb.txt", "# color images\n1.100 rgb/a.png\n1.133 rgb/b.png\n1.300 rgb/c.png\n");
  write("depth.txt", "# depth maps\n1.091 depth/a.png\n1.124 depth/b.png\n1.330 depth/c.png\n");
  const TumSequence sequence = readTumSequence(folder_);
  ASSERT_EQ(sequence.pairs.size(), 2U) << "the third has none within 20 ms";
  EXPECT_EQ(sequence.pairs[1].rgb_path, folder_ + "/rgb/b.png");
  EXPECT_EQ(sequence.pairs[1].depth_path, folder_ + "/depth/b.png");
  ASSERT_EQ(sequence.remarks.size(), 1U);
  EXPECT_NE(sequence.remarks[0].find("of 3 colour images 2 have"), std::string::npos) << sequence.remarks[0];
  write("depth.txt", "1.091\n");
  EXPECT_NE(error().find("depth.txt, line 1"), std::string::npos) << error();
  write("depth.txt", "9 depth/a.png\n");
  EXPECT_NE(error().find("belong together"), std::string::npos) << error();
}

TEST_F(TumSequenceTest, DepthMayComeFirst) {
  write("associations.txt", "1.25 depth/a.png 1.5 rgb/a.jpg\n");
  const TumSequence sequence = readTumSequence(folder_);
  EXPECT_EQ(sequence.pairs[0].rgb_path, folder_ + "/rgb/a.jpg");
  EXPECT_EQ(sequence.pairs[0].rgb_stamp, 1'500'000'000);
  EXPECT_EQ(sequence.pairs[0].depth_stamp, 1'250'000'000);
}

TEST_F(TumSequenceTest, NumbersOfImagesBecomeTimes) {
  write("associations.txt", "0 depth/0.png 0 rgb/0.png\n1 depth/1.png 1 rgb/1.png\n");
  const TumSequence sequence = readTumSequence(folder_, {"icl", 0.0, 25.0});
  EXPECT_EQ(sequence.pairs[0].rgb_stamp, 1'000'000'000'000) << "0 would be no time";
  EXPECT_EQ(sequence.pairs[1].depth_stamp, 1'000'040'000'000);
  write("associations.txt", "0.5 depth/0.png 0 rgb/0.png\n");
  EXPECT_THROW(readTumSequence(folder_, {"icl", 0.0, 25.0}), std::runtime_error);
}

TEST_F(TumSequenceTest, CamerasHaveNames) {
  EXPECT_EQ(readTumSequence(folder_, {"freiburg2", 0.0, 0.0}).fx, 520.9) << "before calib.txt";
  EXPECT_EQ(readTumSequence(folder_, {"freiburg2", 1000.0, 0.0}).depth_scale, 1000.0);
  EXPECT_EQ(readTumSequence(folder_, {"500,-501,320,240", 0.0, 0.0}).fy, 501.0) << "ICL's y axis points up";
  EXPECT_EQ(parseTumCamera("icl").depth_scale, 5000.0);
  for (const char* text : {"freiburg4", "", "500,500,320", "0,500,320,240", "500,0,320,240", "a,b,c,d"})
    EXPECT_THROW(parseTumCamera(text), std::runtime_error) << text;
  EXPECT_EQ(tumCameraOf("rgbd_dataset_freiburg3_long_office_household"), "freiburg3");
  EXPECT_EQ(tumCameraOf("living_room"), "");
  std::filesystem::remove(folder_ + "/calib.txt");
  EXPECT_NE(error().find("--camera freiburg1"), std::string::npos) << error();
  const std::string archive = folder_ + "/rgbd_dataset_freiburg1_xyz";
  std::filesystem::create_directory(archive);
  std::filesystem::copy(folder_ + "/associations.txt", archive);
  EXPECT_EQ(readTumSequence(archive).cy, 255.3);
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
