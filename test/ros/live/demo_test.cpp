// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// demo.launch as a whole: users get what the virtual camera renders, with the right stamps.
#include <cstdio>
#include <fstream>
#include <sstream>

#include "live_test.h"
#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/stamp.h"
#include "rgbd_sfm_fusion/scene/room.h"
#include "rgbd_sfm_fusion/scene/virtual_camera.h"

namespace rgbd_sfm_fusion {
namespace {

using sensor_msgs::CameraInfo;
using sensor_msgs::Image;

constexpr std::size_t kFrames = 30;
constexpr double kPairTolerance = 1e-3;  // [s]

/// [s] From a stamp to that of the message nearest to it in time.
template <class Message>
double distance(const Inbox<Message>& inbox, ros::Time stamp) {
  double nearest = 1e9;
  for (const auto& message : inbox.messages)
    nearest = std::min(nearest, std::abs((message->header.stamp - stamp).toSec()));
  return nearest;
}

/// Number of images for which another topic has a message with the same stamp, within a tolerance [s].
template <class Message>
std::size_t partners(const Inbox<Image>& images, const Inbox<Message>& others, double tolerance) {
  return static_cast<std::size_t>(
      std::count_if(images.messages.begin(), images.messages.end(),
                    [&](const auto& image) { return distance(others, image->header.stamp) <= tolerance; }));
}

/// Index of each logged frame, by the host's time at which it was due [ns].
std::map<Stamp, std::uint32_t> readLog(const std::string& path) {
  std::ifstream file(path);
  std::map<Stamp, std::uint32_t> frames;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::uint32_t index;
    std::uint64_t device_time;
    Stamp host_time;
    if (words >> index >> device_time >> host_time) frames[host_time] = index;
  }
  return frames;
}

TEST(Demo, ImagesAreThoseOfTheCameraAndCarryItsTime) {
  Inbox<Image> colour("/camera/rgb/image_raw"), depth("/camera/depth_registered/image_raw"),
      mean("/fusion/mean");
  Inbox<CameraInfo> colour_info("/camera/rgb/camera_info"),
      depth_info("/camera/depth_registered/camera_info");
  ASSERT_TRUE(spinUntil([&] { return mean.messages.size() >= kFrames; }, 60.0));
  // Messages of the last frame may still be on their way, and half of the first frame may have been missed:
  // leave both out.
  for (Inbox<Image>* images : {&colour, &depth, &mean}) {
    images->messages.erase(images->messages.begin());
    images->messages.pop_back();
  }
  EXPECT_EQ(partners(colour, colour_info, 0.0), colour.messages.size());
  EXPECT_EQ(partners(depth, depth_info, 0.0), depth.messages.size());
  EXPECT_GE(partners(depth, colour, kPairTolerance), depth.messages.size() - 2);
  EXPECT_GE(partners(mean, colour, 0.0), mean.messages.size() - 2);
  EXPECT_EQ(colour.messages.front()->encoding, "rgb8");
  EXPECT_EQ(depth.messages.front()->encoding, "16UC1");
  for (const Inbox<CameraInfo>* infos : {&colour_info, &depth_info}) {
    const CameraInfo& info = *infos->messages.front();
    EXPECT_EQ(info.header.frame_id, "camera_rgb_optical_frame");
    EXPECT_NEAR(info.K[0], 525.0, 0.1);
    EXPECT_NEAR(info.K[2], 319.5, 0.1);
  }
  EXPECT_EQ(mean.messages.front()->header.frame_id, "camera_rgb_optical_frame");

  const std::string path = ros::param::param<std::string>("/camera_log", "");
  const std::map<Stamp, std::uint32_t> log = readLog(path);
  ASSERT_FALSE(log.empty()) << path;
  VirtualCameraOptions options;
  options.seed = 5;
  options.rate = 10.0;
  VirtualCamera camera(options, sharedRoom());
  for (std::size_t i = colour.messages.size() / 2; i < colour.messages.size(); i += 5) {
    const Stamp stamp = fromRosTime(colour.messages[i]->header.stamp);
    const auto after = log.lower_bound(stamp - 50'000'000);  // half of the time between frames
    ASSERT_NE(after, log.end());
    EXPECT_NEAR(static_cast<double>(stamp - after->first), 0.0, 2e7) << "ns";
    EXPECT_EQ(cv::norm(viewImage(colour.messages[i]), camera.frame(after->second).rgb, cv::NORM_INF), 0.0)
        << i;
  }
  std::remove(path.c_str());
}

}  // namespace
}  // namespace rgbd_sfm_fusion

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "demo_test");
  ros::NodeHandle handle;  // lives as long as the tests: without any, ROS shuts down
  return RUN_ALL_TESTS();
}
