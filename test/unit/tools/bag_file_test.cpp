// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tools/bag_file.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>
#include "../temporary_path.h"

namespace rgbd_sfm_fusion {
namespace {

std::string number(std::uint64_t value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i) & 0xFF);
  return text;
}

std::string field(const std::string& name, const std::string& value) {
  return number(name.size() + 1 + value.size(), 4) + name + "=" + value;
}

std::string record(int op, const std::string& fields, const std::string& data) {
  const std::string header = field("op", number(static_cast<std::uint64_t>(op), 1)) + fields;
  return number(header.size(), 4) + header + number(data.size(), 4) + data;
}

std::uint64_t rosTime(std::uint64_t seconds, std::uint64_t nanoseconds) {
  return seconds | nanoseconds << 32U;
}

/// A bag as in https://wiki.ros.org/Bags/Format/2.0, with one chunk of two messages in reverse order.
struct TestBag {
  std::string compression = "none";
  std::string chunk;                ///< as in the file; empty: made from the messages
  std::uint32_t chunk_size = 0;     ///< [bytes] uncompressed; 0: the size of the messages
  std::uint32_t second_offset = 0;  ///< 0: where the second message is
  std::uint32_t index_count = 2;
  std::uint32_t connection_count = 1;
  std::uint32_t chunk_infos = 1;  ///< all of the same chunk
  std::uint64_t chunk_position = 4117;
  std::string file_header;  ///< further fields

  std::string bytes() const {
    const std::string connection =
        record(7, field("conn", number(0, 4)) + field("topic", "/a"),
               field("topic", "/a") + field("type", "std_msgs/String") + field("md5sum", "123"));
    const auto message = [](std::uint64_t time, const std::string& data) {
      return record(2, field("conn", number(0, 4)) + field("time", number(time, 8)), data);
    };
    const std::string first = connection + message(rosTime(11, 5), "late"),
                      second = message(rosTime(10, 7), "early");
    const std::string data = chunk.empty() ? first + second : chunk;
    const std::string packed =
        record(5,
               field("compression", compression) +
                   field("size", number(chunk_size == 0 ? data.size() : chunk_size, 4)),
               data);
    const std::string entries = number(rosTime(11, 5), 8) + number(0, 4) + number(rosTime(10, 7), 8) +
                                number(second_offset == 0 ? first.size() : second_offset, 4);
    const std::string index = record(
        4, field("ver", number(1, 4)) + field("conn", number(0, 4)) + field("count", number(index_count, 4)),
        entries);
    const std::string info =
        record(6,
               field("ver", number(1, 4)) + field("chunk_pos", number(chunk_position, 8)) +
                   field("count", number(1, 4)),
               number(0, 4) + number(2, 4));
    std::string infos;
    for (std::uint32_t i = 0; i < chunk_infos; ++i) infos += info;
    const std::string body = packed + index;
    std::string header = field("index_pos", number(4117 + body.size(), 8)) +
                         field("conn_count", number(connection_count, 4)) +
                         field("chunk_count", number(chunk_infos, 4)) + file_header;
    const std::size_t used = record(3, header, "").size();
    return "#ROSBAG V2.0\n" + record(3, header, std::string(4104 - used, ' ')) + body + connection + infos;
  }
};

class BagFileTest : public ::testing::Test {
 protected:
  void TearDown() override { std::remove(path_.c_str()); }

  const std::string& write(const std::string& bytes) const {
    std::ofstream(path_, std::ios::binary | std::ios::trunc) << bytes;
    return path_;
  }

  /// Reads everything. @return the error, or an empty text
  std::string errorOf(const std::string& bytes) const {
    try {
      readAll(bytes);
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(std::string(error.what()).find(path_), 0U) << error.what();
      return error.what();
    }
    return "";
  }

  std::vector<std::string> readAll(const std::string& bytes) const {
    BagFile bag(write(bytes));
    std::vector<std::string> messages;
    for (std::size_t i = 0; i < bag.connections().size(); ++i) {
      for (const BagFile::Entry& entry : bag.entries(i)) {
        const std::vector<std::uint8_t> message = bag.read(i, entry);
        messages.emplace_back(message.begin(), message.end());
      }
    }
    return messages;
  }

  void expectError(const TestBag& bag, const std::string& reason) const {
    EXPECT_NE(errorOf(bag.bytes()).find(reason), std::string::npos) << errorOf(bag.bytes());
  }

  std::string path_ = temporaryPath("bag_file_test.bag");
};

TEST_F(BagFileTest, GivesMessagesInOrderOfTime) {
  EXPECT_EQ(readAll(TestBag().bytes()), (std::vector<std::string>{"early", "late"}));
  BagFile bag(path_);
  ASSERT_EQ(bag.connections().size(), 1U);
  EXPECT_EQ(bag.connections()[0].topic, "/a");
  EXPECT_EQ(bag.connections()[0].type, "std_msgs/String");
  EXPECT_EQ(bag.connections()[0].md5sum, "123");
  EXPECT_EQ(bag.entries(0)[1].time, 11'000'000'005);
}

TEST_F(BagFileTest, ClaimsThatCannotBeTrueAreErrors) {
  TestBag bag;
  bag.second_offset = 0xFFFFFFFF;
  expectError(bag, "is longer than what holds it");
  bag = {};
  bag.second_offset = 7;
  expectError(bag, "is damaged");
  bag = {};
  bag.index_count = 0x20000000;
  expectError(bag, "lists 536870912 messages in 24 bytes");
  bag = {};
  bag.connection_count = 0xFFFFFFFF;
  expectError(bag, "is of kind 6, expected 7");
  bag = {};
  bag.chunk_position = 0xFFFFFFFFFFFFFFFF;
  expectError(bag, "is longer than what holds it");
  bag = {};
  bag.chunk_position = 13;
  expectError(bag, "is of kind 3, expected 5");
  bag = {};
  bag.chunk_infos = 2000;
  expectError(bag, "the same part of the index belongs to several chunks");
  bag = {};
  bag.chunk_size = 1000000;
  expectError(bag, "is uncompressed, but claims 1000000 bytes");
  bag = {};
  bag.compression = "zip";
  expectError(bag, "compression 'zip', expected none, lz4 or bz2");
  bag = {};
  bag.file_header = field("encryptor", "rosbag/AesCbcEncryptor");
  expectError(bag, "is encrypted (rosbag/AesCbcEncryptor)");
}

TEST_F(BagFileTest, DamagedCompressionIsAnError) {
  for (const char* compression : {"lz4", "bz2"}) {
    TestBag bag;
    bag.compression = compression;
    bag.chunk = "this is neither of them";
    bag.chunk_size = 500;
    expectError(bag, std::string(compression) + ": ");
    bag.chunk_size = 0xFFFFFFFF;
    expectError(bag, "claims to hold 4294967295 bytes");
  }
}

TEST_F(BagFileTest, WhatIsCutOffHasNoIndex) {
  const std::string bytes = TestBag().bytes();
  for (std::size_t size = 1; size < bytes.size(); size += size < 4000 ? 397 : 1) {
    const std::string error = errorOf(bytes.substr(0, size));
    EXPECT_NE(error, "") << size;
    const bool lacks_its_index = size >= 4117 && size < bytes.size() - 200;
    EXPECT_TRUE(!lacks_its_index || error.find("rosbag reindex") != std::string::npos) << error;
  }
}

TEST_F(BagFileTest, AnyFlippedByteIsSurvived) {
  const std::string bytes = TestBag().bytes();
  std::mt19937 random(5);
  for (int trial = 0; trial < 3000; ++trial) {
    std::string damaged = bytes;
    for (int i = 0; i < 3; ++i) {
      const std::size_t at = random() % 4 == 0 ? random() % 100 : 4117 + random() % (bytes.size() - 4117);
      damaged[at] = static_cast<char>(random() % 3 == 0 ? 0xFF : random());
    }
    errorOf(damaged);
  }
}

TEST_F(BagFileTest, OtherFilesAreNamed) {
  EXPECT_NE(errorOf("").find("is empty"), std::string::npos);
  EXPECT_NE(errorOf("PNG or whatever").find("is no bag"), std::string::npos);
  EXPECT_NE(errorOf("#ROSBAG V1.2\nwhatever").find("another format (#ROSBAG V1.2)"), std::string::npos);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
