// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// fuse_bag with the same frames in every form that it takes. If a form decodes to the same bits, the result
/// is the same.
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <tf2_msgs/TFMessage.h>

#include <functional>
#include <string>
#include <vector>

#include "fuse_bag_fixture.h"
#include "input_forms.h"

namespace rgbd_sfm_fusion {
namespace {

class FuseBagFormsTest : public FuseBagTest {
 protected:
  static std::string path() { return folder() + "/form.bag"; }

  static void write(const std::function<void(int frame, SentFrame&)>& change, int frames = kFrames) {
    FakeCamera camera;
    camera.hole = 0.3F;
    rosbag::Bag bag(path(), rosbag::bagmode::Write);
    for (int i = 0; i < frames; ++i) {
      SentFrame frame = sentFrame(camera, i);
      change(i, frame);
      const ros::Time arrival = toRosTime(camera.stamp(i));
      bag.write("/camera/rgb/camera_info", arrival, frame.info);
      bag.write("/camera/rgb/image_raw", arrival, *frame.colour);
      if (frame.depth) bag.write("/camera/depth_registered/image_raw", arrival, *frame.depth);
      if (frame.depth_info) bag.write("/camera/depth_registered/camera_info", arrival, *frame.depth_info);
    }
  }

  static std::string trajectory() { return content(results() + "/trajectory.txt"); }

  /// Trajectory from the usual images.
  static std::string plainTrajectory() {
    const Outcome outcome = fuse("");
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    return trajectory();
  }

  static void expectSaid(const Outcome& outcome, const std::string& text) {
    EXPECT_NE(outcome.output.find(text), std::string::npos) << outcome.output;
  }

  static void expectAllTracked(const Outcome& outcome, int frames = kFrames) {
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    const std::string n = std::to_string(frames);
    expectSaid(outcome, n + " frames: " + n + " tracked");
  }
};

TEST_F(FuseBagFormsTest, EveryFormIsTaken) {
  const int frames = 6;
  write([](int, SentFrame&) {}, frames);
  expectAllTracked(fuse("", path()), frames);
  const std::string plain = trajectory();
  for (const InputForm& form : inputForms()) {
    SCOPED_TRACE(form.name);
    write([&](int, SentFrame& frame) { form.change(frame); }, frames);
    expectAllTracked(fuse("", path()), frames);
    if (form.has_same_bits) {
      EXPECT_EQ(trajectory(), plain);
    }
  }
}

TEST_F(FuseBagFormsTest, DepthOfTheInfraredCamerasInfoIsSaidToBe) {
  write([](int, SentFrame& frame) {
    frame.depth_info = frame.info;
    frame.depth_info->K[0] *= 1.12;
  });
  expectSaid(fuse("", path()), "the depth camera_info differs from that of colour, which is used: K[0]");
}

TEST_F(FuseBagFormsTest, DepthThatIsNotRegisteredIsSaidToBe) {
  write([](int, SentFrame& frame) { frame.depth->header.frame_id = "camera_depth_optical_frame"; });
  expectSaid(fuse("", path()), "depth is in frame camera_depth_optical_frame");
}

TEST_F(FuseBagFormsTest, DepthInTumsUnitIsSaidToBeAndTakenWithItsScale) {
  const std::string plain = plainTrajectory();
  write([](int, SentFrame& frame) {
    auto* counts = reinterpret_cast<std::uint16_t*>(frame.depth->data.data());
    for (std::size_t i = 0; i < frame.depth->data.size() / 2; ++i)
      counts[i] = static_cast<std::uint16_t>(5 * counts[i]);
  });
  expectSaid(fuse("", path()), "set depth_scale, e.g. 0.0002 for TUM's PNGs");
  expectAllTracked(fuse("--set depth_scale=0.0002", path()));
  EXPECT_EQ(trajectory(), plain);
}

TEST_F(FuseBagFormsTest, DepthFarFromColourInTimeIsSaidToBeAndTakenWithALargerLimit) {
  const int rarely = 3;  // of 30 Hz
  write([&](int i, SentFrame& frame) {
    frame.colour->header.stamp = toRosTime(FakeCamera().stamp(rarely * i));
    frame.depth->header.stamp = frame.colour->header.stamp + ros::Duration(0.04);
  });
  const Outcome outcome = fuse("", path());
  expectFailure(outcome, "nothing could be tracked or fused");
  expectSaid(outcome, "max_skew (20 ms): the nearest is 40 ms away");
  expectAllTracked(fuse("--set max_skew=0.05", path()));
}

TEST_F(FuseBagFormsTest, RatesFrom5To60HzAndDepthAtAThirdOfColoursAreTaken) {
  for (const double rate : {5.0, 10.0, 15.0, 60.0}) {
    SCOPED_TRACE(rate);
    write([&](int i, SentFrame& frame) {
      const auto stamp = FakeCamera().first_stamp + fromSeconds(i / rate);
      frame.colour->header.stamp = frame.depth->header.stamp = toRosTime(stamp);
    });
    expectAllTracked(fuse("", path()));
  }
  write([](int i, SentFrame& frame) {
    if (i % 3 != 0) frame.depth.reset();
  });
  expectAllTracked(fuse("", path()));
}

TEST_F(FuseBagFormsTest, WhatIsLostIsCountedAndFoundAgain) {
  const auto expectFoundAgain = [](const Outcome& outcome, int frames) {
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    expectSaid(outcome, std::to_string(frames) + " frames: ");
    EXPECT_EQ(outcome.output.find(" 0 lost"), std::string::npos) << outcome.output;
    const std::vector<std::string> rows = lines(content(results() + "/frames.csv"));
    EXPECT_NE(rows.back().find(",tracking,"), std::string::npos) << rows.back();
  };
  const int first = 15, end = 45, frames = 80;  // a second of a white wall, or in the dark
  for (const bool is_dark : {false, true}) {
    write(
        [&](int i, SentFrame& frame) {
          if (i < first || i >= end) return;
          frame.colour->data.assign(frame.colour->data.size(), is_dark ? 3 : 200);
        },
        frames);
    expectFoundAgain(fuse("", path()), frames);
  }
}

TEST_F(FuseBagFormsTest, ImagesAsJpegAndDepthAsInverseAreNearlyTheSame) {
  FakeCamera camera;
  {
    rosbag::Bag bag(path(), rosbag::bagmode::Write);
    for (int i = 0; i < kFrames; ++i) {
      const ros::Time arrival = toRosTime(camera.stamp(i));
      bag.write("/camera/rgb/camera_info", arrival, camera.info(i));
      bag.write("/camera/rgb/image_raw/compressed", arrival,
                compress(camera.colour(i), "rgb8; jpeg compressed bgr8", 0, ".jpg"));
      bag.write("/camera/depth_registered/image_raw/compressedDepth", arrival,
                compressAsInverse(camera.depthImage(i)));
    }
  }
  expectAllTracked(fuse("", path()));
  const std::vector<std::string> poses = lines(trajectory());
  std::istringstream last(poses.back());
  double stamp = 0.0, x = 0.0;
  last >> stamp >> x;
  EXPECT_NEAR(x, (kFrames - 1) * FakeCamera::kStep, 0.003);
}

TEST_F(FuseBagFormsTest, TransformsOfOthersChangeNothing) {
  const std::string plain = plainTrajectory();
  write([](int, SentFrame&) {});
  rosbag::Bag bag(path(), rosbag::bagmode::Append);
  for (int i = 0; i < kFrames; ++i) {
    tf2_msgs::TFMessage tf;
    tf.transforms.resize(1);
    tf.transforms[0].header = FakeCamera().header(FakeCamera().stamp(i));
    tf.transforms[0].header.frame_id = "world";
    tf.transforms[0].child_frame_id = "camera_rgb_optical_frame";
    tf.transforms[0].transform.rotation.w = 1.0;
    bag.write("/tf", tf.transforms[0].header.stamp, tf);
  }
  bag.close();
  expectAllTracked(fuse("", path()));
  EXPECT_EQ(trajectory(), plain);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
