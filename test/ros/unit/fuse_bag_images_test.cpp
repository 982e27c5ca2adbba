// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// fuse_bag with images that are late, damaged, or not what is needed.
#include <gtest/gtest.h>
#include <rosbag/bag.h>

#include <fstream>
#include <string>

#include "fake_camera.h"
#include "fuse_bag_fixture.h"
#include "rgbd_sfm_fusion/tools/text_format.h"

namespace rgbd_sfm_fusion {
namespace {

TEST_F(FuseBagTest, LateImagesAreLeftOutAndCounted) {
  FakeCamera camera;
  rosbag::Bag bag(folder() + "/late.bag", rosbag::bagmode::Write);
  for (int frame = 0; frame < kFrames; ++frame) {
    const sensor_msgs::ImagePtr colour = camera.colour(frame), depth = camera.depthImage(frame);
    if (frame == 7) colour->header.stamp -= ros::Duration(0.04);
    if (frame == 9) depth->header.stamp = ros::Time(1.0);
    const ros::Time arrival = toRosTime(camera.stamp(frame));
    bag.write("/camera/rgb/camera_info", arrival, camera.info(frame));
    bag.write("/camera/rgb/image_raw", arrival, *colour);
    bag.write("/camera/depth_registered/image_raw", arrival, *depth);
  }
  bag.close();
  const Outcome outcome = fuse("", folder() + "/late.bag");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("14 frames: 14 tracked"), std::string::npos) << outcome.output;
  for (const std::string topic : {"/camera/rgb/image_raw", "/camera/depth_registered/image_raw"})
    EXPECT_NE(outcome.output.find(topic + ": 1 of 15 images were late"), std::string::npos) << outcome.output;
  EXPECT_EQ(content(results() + "/trajectory.txt").find("# run"), std::string::npos);
}

TEST_F(FuseBagTest, UncalibratedCamerasAreRefused) {
  BagOutput bag(folder() + "/uncalibrated.bag");
  const FakeCamera camera;
  sensor_msgs::CameraInfo info = camera.info(0);
  info.K[0] = info.P[0] = 0.0;
  bag.write("/camera/rgb/camera_info", info);
  bag.write("/camera/rgb/image_raw", *camera.colour(0));
  bag.write("/camera/depth_registered/image_raw", *camera.depthImage(0));
  bag.commit();
  const Outcome outcome = fuse("", folder() + "/uncalibrated.bag");
  expectFailure(outcome, "/uncalibrated.bag, /camera/rgb/camera_info: ");
  EXPECT_NE(outcome.output.find("K[0]"), std::string::npos) << outcome.output;
}

/// Writes a bag of kFrames frames. `change` may change each of them before.
template <class Change>
std::string writeChanged(const std::string& path, Change change) {
  FakeCamera camera;
  rosbag::Bag bag(path, rosbag::bagmode::Write);
  for (int frame = 0; frame < kFrames; ++frame) {
    const sensor_msgs::ImagePtr colour = camera.colour(frame), depth = camera.depthImage(frame);
    sensor_msgs::CameraInfo info = camera.info(frame);
    change(frame, *colour, *depth, info);
    const ros::Time arrival = toRosTime(camera.stamp(frame));
    bag.write("/camera/rgb/camera_info", arrival, info);
    bag.write("/camera/rgb/image_raw", arrival, *colour);
    bag.write("/camera/depth_registered/image_raw", arrival, *depth);
  }
  return path;
}

TEST_F(FuseBagTest, ImagesThatCannotBeUsedAreLeftOut) {
  using sensor_msgs::Image;
  const std::string path = folder() + "/changed.bag";
  const auto expectLeftOut = [&](const std::string& topic, int frame, const std::string& reason, int frames) {
    const Outcome outcome = fuse("", path);
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    const std::string said =
        topic + ": the message of " + formatStamp(FakeCamera().stamp(frame)) + " s is left out: ";
    EXPECT_NE(outcome.output.find(said), std::string::npos) << outcome.output;
    EXPECT_NE(outcome.output.find(reason), std::string::npos) << outcome.output;
    EXPECT_NE(outcome.output.find(std::to_string(frames) + " frames: " + std::to_string(frames) + " tracked"),
              std::string::npos)
        << outcome.output;
  };
  const std::string colour_topic = "/camera/rgb/image_raw",
                    depth_topic = "/camera/depth_registered/image_raw";
  writeChanged(path, [](int frame, Image& colour, Image&, auto&) {
    if (frame == 4) colour.encoding = "chess";
  });
  expectLeftOut(colour_topic, 4, "chess", kFrames - 1);
  writeChanged(path, [](int frame, Image& colour, Image&, auto&) {
    if (frame >= 4 && frame < 7) colour.data.resize(1000);
  });
  expectLeftOut(colour_topic, 4, "3 messages could not be used, from 1000.132000000 to 1000.198000000 s",
                kFrames - 3);
  writeChanged(path, [](int frame, Image& colour, Image&, auto&) {
    if (frame != 0) return;
    colour.height /= 2;
    colour.data.resize(colour.data.size() / 2);
  });
  expectLeftOut(colour_topic, 0, "120", kFrames - 1);
  writeChanged(path, [](int frame, Image&, Image& depth, auto&) {
    if (frame == 4) depth.encoding = "chess";
  });
  expectLeftOut(depth_topic, 4, "chess", kFrames);
}

TEST_F(FuseBagTest, AMessageThatIsShorterThanItSaysIsLeftOut) {
  std::string bytes = content(input());
  std::size_t at = bytes.find("rgb8", bytes.size() / 2) + 4 + 1 + 4;  // then comes the number of bytes
  bytes.replace(at, 4, "\xff\xff\xff\xff");
  std::ofstream(folder() + "/damaged.bag", std::ios::binary) << bytes;
  const Outcome outcome = fuse("", folder() + "/damaged.bag", "ulimit -v 4000000; ");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("/camera/rgb/image_raw: the message of 1000."), std::string::npos)
      << outcome.output;
  EXPECT_NE(outcome.output.find("shorter than the image that it claims to hold"), std::string::npos)
      << outcome.output;
  EXPECT_NE(outcome.output.find("14 frames: 14 tracked"), std::string::npos) << outcome.output;
}

TEST_F(FuseBagTest, OfTheDepthCameraNothingIsNeeded) {
  FakeCamera camera;
  rosbag::Bag bag(folder() + "/depth_info.bag", rosbag::bagmode::Write);
  for (int frame = 0; frame < 5; ++frame) {
    const ros::Time arrival = toRosTime(camera.stamp(frame));
    sensor_msgs::CameraInfo wrong = camera.info(frame);
    wrong.width = 1U << 31U;
    bag.write("/camera/rgb/camera_info", arrival, camera.info(frame));
    bag.write("/camera/rgb/image_raw", arrival, *camera.colour(frame));
    bag.write("/camera/depth_registered/image_raw", arrival, *camera.depthImage(frame));
    bag.write("/camera/depth_registered/camera_info", arrival, wrong);
  }
  bag.close();
  const Outcome outcome = fuse("", folder() + "/depth_info.bag");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("the depth camera_info cannot be read"), std::string::npos) << outcome.output;
}

TEST_F(FuseBagTest, UnstampedImagesAreLeftOutAndCounted) {
  const std::string path =
      writeChanged(folder() + "/unstamped.bag", [](int frame, auto& colour, auto&, auto&) {
        if (frame == 4) colour.header.stamp = ros::Time();
      });
  const Outcome outcome = fuse("", path);
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("/camera/rgb/image_raw: 1 of 15 images have a stamp of 0"), std::string::npos)
      << outcome.output;
}

TEST_F(FuseBagTest, AnotherDefinitionOfAMessageIsRefused) {
  const std::string bytes = content(input());
  for (const char* md5sum : {ros::message_traits::md5sum<sensor_msgs::Image>(),
                             ros::message_traits::md5sum<sensor_msgs::CameraInfo>()}) {
    std::string changed = bytes;
    for (std::size_t at = changed.find(md5sum); at != std::string::npos; at = changed.find(md5sum))
      changed.replace(at, 4, "0000");
    std::ofstream(folder() + "/old.bag", std::ios::binary) << changed;
    expectFailure(fuse("", folder() + "/old.bag"), std::string("expected ") + md5sum);
  }
}

TEST_F(FuseBagTest, WhatIsMissingForAResultIsSaid) {
  const std::string path = folder() + "/nothing.bag";
  const auto expectNothing = [&](const std::string& sentence) {
    const Outcome outcome = fuse("", path);
    expectFailure(outcome, "nothing could be tracked or fused");
    EXPECT_NE(outcome.output.find(sentence), std::string::npos) << outcome.output;
  };
  writeChanged(path, [](int, auto& colour, auto& depth, auto&) {
    colour.header.stamp = depth.header.stamp = ros::Time();
  });
  expectNothing("/camera/rgb/image_raw: all 15 images have a stamp of 0");
  writeChanged(path, [](int, auto&, auto& depth, auto&) { depth.header.stamp += ros::Duration(12.0); });
  expectNothing("colour and depth must be stamped by the same clock");
  writeChanged(path, [](int, auto&, auto& depth, auto&) { depth.data.assign(depth.data.size(), 0); });
  expectNothing("no pixel has a depth");
  writeChanged(path, [](int, auto& colour, auto&, auto&) { colour.data.assign(colour.data.size(), 100); });
  expectNothing("15 images were not tracked");
  writeChanged(path, [](int, auto& colour, auto&, auto&) { colour.encoding = "chess"; });
  expectNothing("/camera/rgb/image_raw: all 15 images cannot be used");
}

}  // namespace
}  // namespace rgbd_sfm_fusion
