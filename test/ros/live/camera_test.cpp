// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// The camera nodelet on the virtual camera, with tracker and fusion, through absence and unplugging.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <nodelet/NodeletList.h>
#include <tf2_ros/transform_listener.h>

#include <atomic>
#include <cstdio>
#include <fstream>
#include <thread>

#include "live_test.h"

namespace rgbd_sfm_fusion {
namespace {

// As in camera.test.
constexpr std::size_t kUnpluggings = 3;
constexpr double kAbsence = 1.0;   // [s] of each
constexpr double kRecovery = 2.0;  // [s] at most, until there is fused output again
constexpr double kAnswer = 5.0;    // [s] at most; shorter than the device's first absence

constexpr int kExposure = 10;         // the virtual camera's neutral value is 50
constexpr double kDarkerThan = 0.45;  // share of the brightness before

/// Asks the manager something all the time, over one connection. With a connection for each call, roscpp at
/// times fails, because the server closes the connection with its answer (ros_comm issue 1976).
class ManagerProbe {
 public:
  ManagerProbe() : thread_([this] { run(); }) {}
  ~ManagerProbe() { stop(); }

  void stop() {
    stopping_ = true;
    if (thread_.joinable()) thread_.join();
  }

  std::atomic<int> answers{0};
  std::atomic<int> failures{0};
  std::atomic<double> longest{0.0};  ///< [s]

 private:
  void run() {
    if (!ros::service::waitForService("/manager/list", ros::Duration(kPatience))) ++failures;
    auto client = ros::NodeHandle().serviceClient<nodelet::NodeletList>("/manager/list", true);
    while (!stopping_ && ros::ok()) {
      const ros::WallTime start = ros::WallTime::now();
      nodelet::NodeletList list;
      ++(client.call(list) ? answers : failures);
      longest = std::max(longest.load(), (ros::WallTime::now() - start).toSec());
      ros::WallDuration(0.1).sleep();
    }
  }

  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

double brightness(const sensor_msgs::Image& image) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < image.data.size(); i += 97, ++count) sum += image.data[i];
  return sum / static_cast<double>(std::max<std::size_t>(count, 1));
}

/// Notes when fused messages came, and how bright colour was.
class Watch {
 public:
  Watch() {
    fused_ = handle_.subscribe<sensor_msgs::CameraInfo>(
        "/fusion/camera_info", 100,
        [this](const sensor_msgs::CameraInfoConstPtr& info) { onFused(info->header.stamp); });
    colour_ = handle_.subscribe<sensor_msgs::Image>(
        "/camera/rgb/image_raw", 2,
        [this](const sensor_msgs::ImageConstPtr& image) { last_brightness = brightness(*image); });
  }

  std::size_t fused = 0;
  std::vector<double> gaps;  ///< [s] from the last image before an absence to the first message after it
  double last_brightness = -1.0;

 private:
  void onFused(const ros::Time& stamp) {
    if (fused > 0 && (stamp - last_).toSec() > 0.9 * kAbsence)
      gaps.push_back((ros::Time::now() - last_).toSec());
    last_ = stamp;
    ++fused;
  }

  ros::NodeHandle handle_;
  ros::Subscriber fused_, colour_;
  ros::Time last_;
};

dynamic_reconfigure::Config configure(const dynamic_reconfigure::Config& config) {
  dynamic_reconfigure::Reconfigure call;
  call.request.config = config;
  EXPECT_TRUE(ros::service::call("/camera/driver/set_parameters", call));
  return call.response.config;
}

void setExposure() {
  dynamic_reconfigure::Config config;
  config.bools.resize(1);
  config.bools[0].name = "auto_exposure";
  config.bools[0].value = 0;
  config.ints.resize(1);
  config.ints[0].name = "exposure";
  config.ints[0].value = kExposure;
  configure(config);
}

std::string setDepthMode(const std::string& mode) {
  dynamic_reconfigure::Config config;
  config.strs.resize(1);
  config.strs[0].name = "depth_mode";
  config.strs[0].value = mode;
  for (const auto& text : configure(config).strs) {
    if (text.name == "depth_mode") return text.value;
  }
  return "no answer";
}

/// Frames that the virtual camera has delivered, by its log.
std::size_t countFrames(const std::string& log) {
  std::ifstream file(log);
  std::size_t frames = 0;
  for (std::string line; std::getline(file, line);) frames += line[0] == '#' ? 0U : 1U;
  return frames;
}

TEST(Camera, IsWaitedForAndComesBackWhenUnplugged) {
  ManagerProbe manager;
  Console console;
  Watch watch;
  ASSERT_TRUE(spinUntil([&] { return watch.fused > 5 && watch.last_brightness > 0.0; }, 40.0));
  EXPECT_GT(manager.answers, 10);  // while the camera was absent, and after that

  const double bright = watch.last_brightness;
  setExposure();
  EXPECT_TRUE(spinUntil([&] { return watch.last_brightness < kDarkerThan * bright; }));
  for (const char* mode : {"640 by 480", "641x480@30", ""})
    EXPECT_EQ(setDepthMode(mode), "640x480@30") << mode;

  EXPECT_TRUE(spinUntil([&] { return watch.gaps.size() >= kUnpluggings; }, 40.0))
      << ::testing::PrintToString(watch.gaps);
  for (const double gap : watch.gaps) EXPECT_LT(gap, kAbsence + kRecovery);
  const std::size_t fused = watch.fused;
  EXPECT_TRUE(spinUntil([&] { return watch.fused > fused + 5; }));
  EXPECT_LT(watch.last_brightness, kDarkerThan * bright) << "exposure is not what was set before";

  manager.stop();
  EXPECT_EQ(manager.failures, 0);
  EXPECT_LT(manager.longest, kAnswer);
}

TEST(Camera, GivesInfoOfItsImagesAndFrames) {
  Inbox<sensor_msgs::Image> colour("/camera/rgb/image_raw"), depth("/camera/depth_registered/image_raw");
  Inbox<sensor_msgs::CameraInfo> colour_info("/camera/rgb/camera_info"),
      depth_info("/camera/depth_registered/camera_info");
  ASSERT_TRUE(spinUntil([&] { return depth.messages.size() > 5 && colour.messages.size() > 5; }));
  const auto depth_image = depth.messages.back();
  const Stamp stamp = fromRosTime(depth_image->header.stamp);
  ASSERT_TRUE(colour.at(stamp) && colour_info.at(stamp) && depth_info.at(stamp)) << "pairs have one stamp";
  EXPECT_EQ(colour.at(stamp)->encoding, "rgb8");
  EXPECT_EQ(depth_image->encoding, "16UC1");
  EXPECT_EQ(depth_image->header.frame_id, "camera_rgb_optical_frame");
  EXPECT_EQ(colour.at(stamp)->header.frame_id, depth_image->header.frame_id);
  EXPECT_EQ(colour_info.at(stamp)->header.frame_id, depth_image->header.frame_id);
  EXPECT_EQ(depth_info.at(stamp)->header.frame_id, depth_image->header.frame_id);
  EXPECT_EQ(colour_info.at(stamp)->K, depth_info.at(stamp)->K);
  EXPECT_EQ(colour_info.at(stamp)->K[0], 526.5) << "as in calibration.yaml";

  tf2_ros::Buffer buffer;
  tf2_ros::TransformListener listener(buffer);
  ASSERT_TRUE(spinUntil(
      [&] { return buffer.canTransform("camera_link", "camera_rgb_optical_frame", ros::Time(0)); }));
  const auto rotation =
      buffer.lookupTransform("camera_link", "camera_rgb_optical_frame", ros::Time(0)).transform.rotation;
  for (const double part : {-rotation.x, rotation.y, -rotation.z, rotation.w}) EXPECT_NEAR(part, 0.5, 1e-6);
}

TEST(Camera, StreamsNothingThatNobodyWants) {
  Inbox<diagnostic_msgs::DiagnosticArray> diagnostics("/diagnostics");
  EXPECT_TRUE(spinUntil([&] {
    for (const auto& array : diagnostics.messages) {
      for (const auto& status : array->status) {
        if (status.name == "idle_camera/driver: camera" && status.message == "ready; nobody subscribes")
          return true;
      }
    }
    return false;
  }));
  const auto path = ros::param::param<std::string>("/idle_camera_log", "");
  EXPECT_EQ(countFrames(path), 0U);

  // A look at the log itself: as soon as somebody subscribes, there are frames in it.
  Console console;
  Inbox<sensor_msgs::Image> colour("/idle_camera/rgb/image_raw");
  Inbox<sensor_msgs::CameraInfo> colour_info("/idle_camera/rgb/camera_info");
  EXPECT_TRUE(spinUntil([&] { return colour.messages.size() > 3; }));
  EXPECT_TRUE(spinUntil([&] { return countFrames(path) > 0; })) << path;
  std::remove(path.c_str());

  // Its calibration has another size, so the camera comes from the field of view.
  const auto info = colour_info.at(fromRosTime(colour.messages.back()->header.stamp));
  ASSERT_TRUE(info);
  EXPECT_EQ(info->width, 640U);
  EXPECT_NEAR(info->K[0], 525.0, 1e-3);
  EXPECT_EQ(console.count({"the calibration of rgb is for 320x240"}), 1U);
}

}  // namespace
}  // namespace rgbd_sfm_fusion

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "camera_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
