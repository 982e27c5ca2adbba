// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// fuse_bag with bags as other drivers and tools make them: compressed, under other names, in parts.
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <std_msgs/String.h>

#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "fake_camera.h"
#include "fuse_bag_fixture.h"
#include "input_forms.h"

namespace rgbd_sfm_fusion {
namespace {

class FuseBagTopicsTest : public FuseBagTest {
 protected:
  /// Trajectory from the usual bag of raw images.
  static std::string plainTrajectory() {
    const Outcome outcome = fuse("");
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    return content(results() + "/trajectory.txt");
  }

  static Outcome expectSameAsPlain(const std::string& options, const std::string& bags) {
    const std::string plain = plainTrajectory();
    const Outcome outcome = fuse(options, bags);
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_EQ(content(results() + "/trajectory.txt"), plain);
    return outcome;
  }

  static void expectSaid(const Outcome& outcome, const std::string& text) {
    EXPECT_NE(outcome.output.find(text), std::string::npos) << outcome.output;
  }

  static std::string path() { return folder() + "/other.bag"; }
};

TEST_F(FuseBagTopicsTest, CompressedImagesAreTheSameImages) {
  writeFrames(path(), [](rosbag::Bag& bag, const FakeCamera& camera, int frame, const ros::Time& arrival) {
    bag.write("/camera/rgb/camera_info", arrival, camera.info(frame));
    bag.write("/camera/rgb/image_raw/compressed", arrival,
              compress(camera.colour(frame), "rgb8; png compressed ", 0));
    bag.write("/camera/depth_registered/image_raw/compressedDepth", arrival,
              compress(camera.depthImage(frame), "16UC1; compressedDepth", 12));
  });
  const Outcome found = expectSameAsPlain("", path());
  expectSaid(found,
             "colour /camera/rgb/image_raw/compressed, depth "
             "/camera/depth_registered/image_raw/compressedDepth, calibration /camera/rgb/camera_info");
  expectSameAsPlain("--rgb /camera/rgb/image_raw --depth /camera/depth_registered/image_raw", path());
}

TEST_F(FuseBagTopicsTest, ABrokenCompressedImageIsLeftOut) {
  writeFrames(path(), [](rosbag::Bag& bag, const FakeCamera& camera, int frame, const ros::Time& arrival) {
    sensor_msgs::CompressedImage colour = compress(camera.colour(frame), "rgb8; png compressed ", 0);
    if (frame == 4) colour.data.resize(colour.data.size() / 2);
    bag.write("/camera/rgb/camera_info", arrival, camera.info(frame));
    bag.write("/camera/rgb/image_raw/compressed", arrival, colour);
    bag.write("/camera/depth_registered/image_raw", arrival, *camera.depthImage(frame));
  });
  const Outcome outcome = fuse("", path());
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  expectSaid(outcome,
             "/camera/rgb/image_raw/compressed: the message of 1000.132000000 s is left out: PNG of");
  expectSaid(outcome, "14 frames: 14 tracked");
}

TEST_F(FuseBagTopicsTest, OtherNamesAreFound) {
  writeFrames(path(), [](rosbag::Bag& bag, const FakeCamera& camera, int frame, const ros::Time& arrival) {
    bag.write("/cam/rgb/camera_info", arrival, camera.info(frame));
    bag.write("/cam/rgb/image_color", arrival, *camera.colour(frame));
    bag.write("/cam/depth/image", arrival, *camera.depthImage(frame));
    bag.write("/cam/depth/camera_info", arrival, camera.info(frame));
    bag.write("/cam/ir/image", arrival, *camera.depthImage(frame));
  });
  const Outcome outcome = fuse("", path());
  expectFailure(outcome, "2 topics have depth images: name one by --depth TOPIC");
  expectSaid(outcome, "/cam/ir/image: 16UC1 of 320x240 px");
  expectSaid(expectSameAsPlain("--depth /cam/depth/image", path()), "colour /cam/rgb/image_color");
}

TEST_F(FuseBagTopicsTest, SeveralBagsAreOne) {
  const WriteFrame write = [](rosbag::Bag& bag, const FakeCamera& camera, int frame,
                              const ros::Time& arrival) {
    bag.write("/camera/rgb/camera_info", arrival, camera.info(frame));
    bag.write("/camera/rgb/image_raw", arrival, *camera.colour(frame));
    bag.write("/camera/depth_registered/image_raw", arrival, *camera.depthImage(frame));
  };
  const std::string first = writeFrames(folder() + "/a.bag", write, 0, 6);
  const std::string second = writeFrames(folder() + "/b.bag", write, 6);
  expectSameAsPlain("", first + " " + second);
  TearDown(), SetUp();
  expectFailure(fuse("", first + " " + folder() + "/c.bag"), "c.bag: there is no such file");
  expectFailure(runCommand(std::string(FUSE_BAG) + " " + first + " " + second + " --output " + second +
                           " --results " + results()),
                "that would destroy the input");
}

TEST_F(FuseBagTopicsTest, TheHomeFolderIsFound) {
  const Outcome outcome = fuse("", "'~/in.bag'", "HOME=" + folder() + " ");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
}

TEST_F(FuseBagTopicsTest, TimeIsCountedFromTheFirstImage) {
  writeFrames(path(), [](rosbag::Bag& bag, const FakeCamera& camera, int frame, const ros::Time& arrival) {
    if (frame == 0) bag.write("/chatter", ros::Time(0, 1000), std_msgs::String());
    bag.write("/camera/rgb/camera_info", arrival, camera.info(frame));
    bag.write("/camera/rgb/image_raw", arrival, *camera.colour(frame));
    bag.write("/camera/depth_registered/image_raw", arrival, *camera.depthImage(frame));
  });
  const Outcome outcome = fuse("--start 0.1 --duration 0.2", path());
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  expectSaid(outcome, "6 frames: 6 tracked");
}

std::string calibrationYaml(const FakeCamera& camera) {
  const PinholeCamera& c = camera.camera();
  const std::string fx = std::to_string(c.fx), fy = std::to_string(c.fy), cx = std::to_string(c.cx),
                    cy = std::to_string(c.cy);
  const auto matrix = [](const std::string& name, int rows, int columns, const std::string& data) {
    return name + ":\n  rows: " + std::to_string(rows) + "\n  cols: " + std::to_string(columns) +
           "\n  data: [" + data + "]\n";
  };
  return "image_width: " + std::to_string(c.width) + "\nimage_height: " + std::to_string(c.height) +
         "\ncamera_name: fake\ndistortion_model: plumb_bob\n" +
         matrix("camera_matrix", 3, 3, fx + ", 0, " + cx + ", 0, " + fy + ", " + cy + ", 0, 0, 1") +
         matrix("distortion_coefficients", 1, 5, "0, 0, 0, 0, 0") +
         matrix("rectification_matrix", 3, 3, "1, 0, 0, 0, 1, 0, 0, 0, 1") +
         matrix("projection_matrix", 3, 4,
                fx + ", 0, " + cx + ", 0, 0, " + fy + ", " + cy + ", 0, 0, 0, 1, 0");
}

TEST_F(FuseBagTopicsTest, ACalibrationFileIsEnough) {
  writeFrames(path(), [](rosbag::Bag& bag, const FakeCamera& camera, int frame, const ros::Time& arrival) {
    bag.write("/camera/rgb/image_raw", arrival, *camera.colour(frame));
    bag.write("/camera/depth_registered/image_raw", arrival, *camera.depthImage(frame));
  });
  const Outcome none = fuse("", path());
  expectFailure(none, "has no /camera/rgb/camera_info, and so no calibration of /camera/rgb/image_raw");
  expectSaid(none, "--calibration FILE");
  const std::string file = folder() + "/camera.yaml";
  std::ofstream(file) << calibrationYaml(FakeCamera());
  expectSameAsPlain("--calibration " + file, path());
  expectSameAsPlain("--calibration file://" + file, path());
  TearDown(), SetUp();
  expectFailure(runCommand(std::string(FUSE_BAG) + " " + path() + " --calibration " + file + " --output " +
                           file + " --results " + results()),
                "that would destroy the input");
}

TEST_F(FuseBagTopicsTest, CalibrationFilesThatAreNoneAreNamed) {
  const std::string file = folder() + "/bad.yaml";
  expectFailure(fuse("--calibration " + folder() + "/none.yaml"), "none.yaml: there is no such file");
  expectFailure(fuse("--calibration http://robot/a.yaml"), "expected a path");
  expectFailure(fuse("--calibration package://no_such_package/a.yaml"), "no package 'no_such_package'");
  for (const std::string text : {"", "max_range: 4\n", ": [", "image_width: 320\nimage_height: x\n"}) {
    std::ofstream(file) << text;
    expectFailure(fuse("--calibration " + file), "bad.yaml: is no calibration");
  }
  std::string zero = calibrationYaml(FakeCamera());
  for (std::size_t at = zero.find("260."); at != std::string::npos; at = zero.find("260."))
    zero.replace(at, 3, "000");
  std::ofstream(file) << zero;
  expectFailure(fuse("--calibration " + file), "bad.yaml: camera_info: K[0] is 0");
}

TEST_F(FuseBagTopicsTest, DepthOfAnotherSizeIsTakenWhereTheRaysAgree) {
  double centre = 0.0;
  const WriteFrame write = [&](rosbag::Bag& bag, const FakeCamera& camera, int frame,
                               const ros::Time& arrival) {
    const sensor_msgs::ImagePtr depth = camera.depthImage(frame);
    depth->height -= 40;
    depth->data.erase(depth->data.begin(), depth->data.begin() + 20 * depth->step);
    depth->data.resize(depth->height * depth->step);
    sensor_msgs::CameraInfo info = camera.info(frame);
    info.height -= 40;
    info.K[5] = centre;
    bag.write("/camera/rgb/camera_info", arrival, camera.info(frame));
    bag.write("/camera/rgb/image_raw", arrival, *camera.colour(frame));
    bag.write("/camera/depth_registered/camera_info", arrival, info);
    bag.write("/camera/depth_registered/image_raw", arrival, *depth);
  };
  centre = 119.5 - 20.0;
  const Outcome agreeing = fuse("", writeFrames(path(), write));
  EXPECT_EQ(agreeing.status, 0) << agreeing.output;
  EXPECT_EQ(agreeing.output.find("warning: /camera/depth_registered"), std::string::npos) << agreeing.output;
  TearDown(), SetUp();
  centre = 119.5 + 20.0;
  const Outcome other = fuse("", writeFrames(path(), write));
  expectFailure(other, "depth image: is 320x200, expected 320x240");
  expectSaid(other, "colour 320x240 px, fx = 260");
}

TEST_F(FuseBagTopicsTest, CameraInfoThatCameOnceIsEnough) {
  writeFrames(path(), [](rosbag::Bag& bag, const FakeCamera& camera, int frame, const ros::Time& arrival) {
    if (frame == 5) bag.write("/camera/rgb/camera_info", arrival, camera.info(frame));
    bag.write("/camera/rgb/image_raw", arrival, *camera.colour(frame));
    bag.write("/camera/depth_registered/image_raw", arrival, *camera.depthImage(frame));
  });
  expectSameAsPlain("", path());
}

/// Images as image_proc makes them: rectified, but with the camera_info of the raw images.
TEST_F(FuseBagTopicsTest, ImagesThatAreRectifiedByTheirNameAreNotRectifiedAgain) {
  std::string name;
  const WriteFrame write = [&](rosbag::Bag& bag, const FakeCamera& camera, int frame,
                               const ros::Time& arrival) {
    sensor_msgs::CameraInfo info = camera.info(frame);
    info.D = {0.26, -0.95, -0.005, 0.003, 1.16};
    info.K[0] *= 0.95;
    bag.write("/camera/rgb/camera_info", arrival, info);
    bag.write("/camera/rgb/" + name, arrival, *camera.colour(frame));
    bag.write("/camera/depth_registered/image_rect", arrival, *camera.depthImage(frame));
    bag.write("/camera/depth_registered/camera_info", arrival, info);
  };
  for (const std::string each : {"image_rect_color", "image_rect", "image_color_rect"}) {
    name = each;
    const Outcome outcome = expectSameAsPlain("", writeFrames(path(), write));
    expectSaid(outcome, "fuse_bag: /camera/rgb/" + name + ": by their name these images are rectified");
    EXPECT_EQ(outcome.output.find("differs from that of colour"), std::string::npos) << outcome.output;
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
