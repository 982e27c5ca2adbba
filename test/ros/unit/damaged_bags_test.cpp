// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// fuse_bag on damaged copies of a bag: cut off, or with changed bytes in headers, index and chunks.
/// RGBD_SFM_FUSION_DAMAGED_BAGS says how many (30 if it is not set).
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "fake_camera.h"
#include "fuse_bag_fixture.h"
#include "rgbd_sfm_fusion/tools/bag_file.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kSeconds = 60;              // for one copy, on a busy machine
constexpr long kMostMemory = 2L << 20;    // [kB]
constexpr std::size_t kFirstRecord = 13;  // after the line that says what the file is
constexpr std::size_t kFirstChunk = 4117;

std::string wholeBag(const std::string& path, rosbag::CompressionType compression) {
  FakeCamera camera;
  camera.colour_encoding = "mono8";
  rosbag::Bag bag(path, rosbag::bagmode::Write);
  bag.setCompression(compression);
  bag.setChunkThreshold(300000);  // two frames
  for (int frame = 0; frame < 6; ++frame) {
    const ros::Time arrival = toRosTime(camera.stamp(frame));
    bag.write("/camera/rgb/camera_info", arrival, camera.info(frame));
    bag.write("/camera/rgb/image_raw", arrival, *camera.colour(frame));
    bag.write("/camera/depth_registered/image_raw", arrival, *camera.depthImage(frame));
  }
  bag.close();
  return content(path);
}

/// Places where records begin, found by the fields that each record has.
std::vector<std::size_t> placesOfRecords(const std::string& bytes) {
  std::vector<std::size_t> places;
  for (std::size_t at = bytes.find("op="); at != std::string::npos; at = bytes.find("op=", at + 1))
    places.push_back(at);
  return places;
}

std::string damaged(const std::string& bytes, std::mt19937& random) {
  const auto below = [&random](std::size_t end) { return random() % end; };
  std::string result = bytes;
  const int kind = static_cast<int>(below(6));
  if (kind == 0) return result.substr(0, below(bytes.size()));
  const std::vector<std::size_t> records = placesOfRecords(bytes);
  const std::size_t index = bytes.rfind("index_pos");
  for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
    std::size_t at = 0;
    if (kind == 1) at = kFirstRecord + below(120);                                      // file header
    if (kind == 2) at = bytes.size() - 1 - below(std::min<std::size_t>(12000, index));  // connections, chunks
    if (kind == 3) at = records[below(records.size())] - 8 + below(60);  // header of any record
    if (kind == 4) at = kFirstChunk + below(200);                        // start of the first chunk
    if (kind == 5) at = below(bytes.size());
    at = std::min(at, bytes.size() - 1);
    const unsigned change = static_cast<unsigned>(below(3));
    result[at] = change == 0 ? '\xFF' : change == 1 ? '\0' : static_cast<char>(random());
  }
  return result;
}

class DamagedBagsTest : public FuseBagTest {};

TEST_F(DamagedBagsTest, EachEndsWithAResultOrAReason) {
  const char* number = std::getenv("RGBD_SFM_FUSION_DAMAGED_BAGS");
  const int copies = number == nullptr ? 30 : std::atoi(number);
  const std::string path = folder() + "/damaged.bag";
  const std::vector<std::string> whole = {wholeBag(path, rosbag::compression::Uncompressed),
                                          wholeBag(path, rosbag::compression::LZ4),
                                          wholeBag(path, rosbag::compression::BZ2)};
  std::map<int, int> endings;
  for (int copy = 0; copy < copies; ++copy) {
    std::mt19937 random(static_cast<unsigned>(copy));
    const std::string bytes = damaged(whole[static_cast<std::size_t>(copy) % whole.size()], random);
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
    const Outcome outcome = fuse("", path, "timeout -k 1 " + std::to_string(kSeconds) + " ");
    SCOPED_TRACE("copy " + std::to_string(copy) + ": " + outcome.output);
    ++endings[outcome.status];
    EXPECT_TRUE(content(path) == bytes) << "the input was changed";
    if (outcome.status == 0) {
      BagFile bag(output());
      for (std::size_t i = 0; i < bag.connections().size(); ++i) {
        for (const BagFile::Entry& entry : bag.entries(i)) bag.read(i, entry);
      }
      EXPECT_EQ(std::distance(fs::directory_iterator(folder() + "/out"), {}), 2) << "bag and results";
      EXPECT_EQ(std::distance(fs::directory_iterator(results()), {}), 6);
    } else {
      EXPECT_EQ(outcome.status, 1) << "a signal, or it took too long";
      EXPECT_NE(outcome.output.find("fuse_bag: "), std::string::npos) << "no reason";
      expectNothingLeft();
    }
    TearDown(), SetUp();
  }
  rusage usage{};
  ASSERT_EQ(getrusage(RUSAGE_CHILDREN, &usage), 0);
  EXPECT_LT(usage.ru_maxrss, kMostMemory) << "kB of memory that one of them took";
  for (const auto& [status, count] : endings) std::printf("%d of %d end with %d\n", count, copies, status);
  std::printf("largest memory: %ld MB\n", usage.ru_maxrss / 1024);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
