// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/bag_messages.h"

#include <gtest/gtest.h>
#include <ros/serialization.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "fake_camera.h"

namespace rgbd_sfm_fusion {
namespace {

template <class Message>
std::vector<std::uint8_t> serialized(const Message& message) {
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  return bytes;
}

/// Every beginning of a message, except the whole message.
template <class Function>
void expectTooShort(const std::vector<std::uint8_t>& bytes, Function read) {
  for (std::size_t size = 0; size < bytes.size(); size += size < 400 ? 1 : bytes.size() / 10) {
    const std::vector<std::uint8_t> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_THROW(read(cut), std::invalid_argument) << size;
  }
}

TEST(BagMessages, AreReadAsRosReadsThem) {
  const FakeCamera camera;
  const std::vector<std::uint8_t> image = serialized(*camera.depthImage(3));
  EXPECT_EQ(serialized(*readImage(image)), image);
  sensor_msgs::CameraInfo calibration = camera.info(3);
  calibration.binning_x = 2;
  calibration.roi.width = 7;
  const std::vector<std::uint8_t> info = serialized(calibration);
  EXPECT_EQ(serialized(readCameraInfo(info)), info);
}

TEST(BagMessages, ThoseThatEndTooSoonAreRefused) {
  const FakeCamera camera;
  expectTooShort(serialized(*camera.colour(0)), readImage);
  expectTooShort(serialized(camera.info(0)), readCameraInfo);
}

TEST(BagMessages, NoMemoryIsAskedForThatIsNotThere) {
  const FakeCamera camera;
  sensor_msgs::Image image = *camera.colour(0);
  image.data.clear();
  std::vector<std::uint8_t> bytes = serialized(image);
  std::memset(&bytes[bytes.size() - 4], 0xFF, 4);  // 4 GB of pixels
  EXPECT_THROW(readImage(bytes), std::invalid_argument);
  sensor_msgs::CameraInfo info = camera.info(0);
  bytes = serialized(info);
  const std::string model = info.distortion_model;
  const auto at = std::search(bytes.begin(), bytes.end(), model.begin(), model.end()) - bytes.begin() +
                  static_cast<std::ptrdiff_t>(model.size());
  std::memset(&bytes[static_cast<std::size_t>(at)], 0xFF, 4);  // 4 G coefficients, which are 32 GB
  EXPECT_THROW(readCameraInfo(bytes), std::invalid_argument);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
