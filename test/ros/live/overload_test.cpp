// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Images come faster than they can be tracked and mapped. Each is fused all the same; those that were left
/// out have the sensor's depth alone. What was left out is in the diagnostics. Here, the tracker keeps a few
/// waiting images: those are tracked, but the map is not refined with all of them, as mapping takes longer
/// than tracking. Nor is there time to fuse all of them with SfM, as that takes longer, too.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <rgbd_sfm_fusion/TrackedFrame.h>

#include <string>

#include "live_test.h"
#include "rgbd_sfm_fusion/fusion/provenance.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kBefore = 5;  // images that are sent one by one, so that there is a map
constexpr int kBurst = 20;  // more than the tracker keeps, fewer than a subscriber does; all are of the first
                            // keyframe
constexpr int kAfter = 3;   // sent one by one again

using Diagnostics = Inbox<diagnostic_msgs::DiagnosticArray>;

/// The value of the last status of a task; -1: there is none.
int lastValue(const Diagnostics& diagnostics, const std::string& task, const std::string& key) {
  int value = -1;
  for (const auto& array : diagnostics.messages) {
    for (const auto& status : array->status) {
      if (status.name.find(task) == std::string::npos) continue;
      for (const auto& pair : status.values) {
        if (pair.key == key) value = std::stoi(pair.value);
      }
    }
  }
  return value;
}

TEST(Overload, EveryImageIsFused) {
  FakeCamera camera({640, 480, 520.0, 520.0, 319.5, 239.5});  // the more pixels, the longer mapping takes
  camera.first_stamp = freshStamp();
  camera.colour_encoding = "mono8";  // the fewer bytes, the sooner the next image is there
  LiveCamera live_camera;
  Inbox<TrackedFrame> frames{"/tracker/frame"};
  Inbox<sensor_msgs::Image> means{"/fusion/mean"}, provenances{"/fusion/provenance"};
  Diagnostics diagnostics{"/diagnostics"};
  ASSERT_TRUE(live_camera.waitForSubscribers());
  ASSERT_TRUE(
      spinUntil([&] { return frames.isConnected() && means.isConnected() && provenances.isConnected(); }));
  callReset();
  // Made beforehand: after a second without depth, colour would not wait for it.
  std::vector<sensor_msgs::ImagePtr> colour, depth;
  for (int frame = kBefore; frame < kBefore + kBurst; ++frame) {
    colour.push_back(camera.colour(frame));
    depth.push_back(camera.depthImage(frame));
  }
  for (int frame = 0; frame < kBefore; ++frame) {
    live_camera.send(camera, frame);
    ASSERT_TRUE(frames.at(camera.stamp(frame)));
  }
  // Depth first: then each colour image can be tracked once it is there.
  for (const auto& image : depth) live_camera.sendDepth(image);
  for (const auto& image : colour) live_camera.sendColour(image);

  int left_out = 0;
  ros::Time last;
  for (int frame = kBefore; frame < kBefore + kBurst; ++frame) {
    const auto tracked = frames.at(camera.stamp(frame));
    ASSERT_TRUE(tracked) << "image " << frame << " of the camera has no tracked frame";
    const auto mean = means.at(camera.stamp(frame));
    ASSERT_TRUE(mean) << "image " << frame << " of the camera was not fused";
    const cv::Mat_<float> metres = viewImage(mean);
    EXPECT_NEAR(metres(120, 160), camera.depth(frame, 160), 0.05F);
    if (!tracked->left_out) continue;
    ++left_out;
    EXPECT_EQ(tracked->state, TrackedFrame::LOST);
    EXPECT_FALSE(tracked->depth_stamp.isZero());
  }
  for (int frame = kBefore + kBurst; frame < kBefore + kBurst + kAfter; ++frame) {
    live_camera.send(camera, frame);
    ASSERT_TRUE(frames.at(camera.stamp(frame)));
  }
  // A frame is tracked against the revision as of two frames before. All but the keyframe should have refined
  // it.
  const auto at_end = frames.at(camera.stamp(kBefore + kBurst + kAfter - 1));
  ASSERT_EQ(fromRosTime(at_end->keyframe_stamp), camera.stamp(0)) << "is meant to stay at one keyframe";
  const int refining = kBefore + kBurst + kAfter - 1 - 2 - left_out;
  const int skipped = refining - static_cast<int>(at_end->keyframe_revision);
  EXPECT_GT(left_out, 0) << "tracking kept up, so that this shows nothing";
  EXPECT_GT(skipped, 0) << "mapping kept up, so that this shows nothing";
  EXPECT_TRUE(spinUntil([&] {
    return lastValue(diagnostics, "tracking", "frames dropped") == left_out &&
           lastValue(diagnostics, "tracking", "frames tracked, but not mapped") == skipped;
  })) << left_out
      << " images and " << skipped << " mappings were left out, but not counted";
  EXPECT_TRUE(spinUntil([&] {
    return lastValue(diagnostics, "fusion", "frames given the sensor's depth alone") > 0;
  })) << "fusion kept up, so that this shows nothing, or what it left out was not counted";
  EXPECT_EQ(lastValue(diagnostics, "fusion", "frames dropped"), 0);
  const auto newest = provenances.at(camera.stamp(kBefore + kBurst + kAfter - 1));
  ASSERT_TRUE(newest);
  EXPECT_GT(cv::countNonZero(viewImage(newest) == static_cast<int>(Provenance::kFused)), 0);
  for (const auto& tracked : frames.messages) {
    EXPECT_GT(tracked->header.stamp, last) << "the order is that of the images";
    last = tracked->header.stamp;
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "overload_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
