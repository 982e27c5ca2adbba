// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// register_depth:=true: the depth camera has another place and focal length, and its depth still gets to the
/// right pixels.
#include <tf2_ros/static_transform_broadcaster.h>

#include "live_test.h"
#include "rgbd_sfm_fusion/TrackedFrame.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kBaseline = 0.2;  // [m] the depth camera is right of the colour camera
constexpr char kDepthFrame[] = "camera_depth_optical_frame";

class RegisterDepthTest : public testing::Test {
 protected:
  void SetUp() override {
    geometry_msgs::TransformStamped mount;
    mount.header.frame_id = camera_.frame_id;
    mount.child_frame_id = kDepthFrame;
    mount.transform = toTransform(SE3(Eigen::Quaterniond::Identity(), {kBaseline, 0.0, 0.0}));
    broadcaster_.sendTransform(mount);
    ASSERT_TRUE(spinUntil([this] {
      return std::min({colour_.getNumSubscribers(), info_.getNumSubscribers(), depth_.getNumSubscribers(),
                       depth_info_.getNumSubscribers()}) > 0 &&
             mean_.isConnected() && frame_.isConnected() && console_.isConnected();
    }));
  }

  /// The wall Z = 2 + 0.3 X as the depth camera sees it.
  sensor_msgs::ImagePtr depthImage(int frame) const {
    cv::Mat_<std::uint16_t> millimetres(depth_camera_.height, depth_camera_.width);
    for (int x = 0; x < millimetres.cols; ++x) {
      const double ray = (x - depth_camera_.cx) / depth_camera_.fx;
      const double depth = (2.0 + 0.3 * (FakeCamera::kStep * frame + kBaseline)) / (1.0 - 0.3 * ray);
      millimetres.col(x) = static_cast<std::uint16_t>(std::lround(1000.0 * depth));
    }
    return toImage(depthHeader(frame), "16UC1", millimetres);
  }

  std_msgs::Header depthHeader(int frame) const {
    std_msgs::Header header = camera_.header(camera_.stamp(frame));
    header.frame_id = kDepthFrame;
    return header;
  }

  Stamp send(int frame) {
    info_.publish(camera_.info(frame));
    depth_info_.publish(toCameraInfo(depthHeader(frame), depth_camera_));
    depth_.publish(depthImage(frame));
    colour_.publish(camera_.colour(frame));
    return camera_.stamp(frame);
  }

  FakeCamera camera_;
  PinholeCamera depth_camera_{320, 240, 230.0, 230.0, 150.0, 118.0};
  ros::NodeHandle handle_;
  tf2_ros::StaticTransformBroadcaster broadcaster_;
  ros::Publisher colour_ = handle_.advertise<sensor_msgs::Image>("/camera/rgb/image_raw", 100);
  ros::Publisher info_ = handle_.advertise<sensor_msgs::CameraInfo>("/camera/rgb/camera_info", 100);
  ros::Publisher depth_ = handle_.advertise<sensor_msgs::Image>("/camera/depth/image_raw", 100);
  ros::Publisher depth_info_ = handle_.advertise<sensor_msgs::CameraInfo>("/camera/depth/camera_info", 100);
  Console console_;
  Inbox<sensor_msgs::Image> mean_{"/fusion/mean"};
  Inbox<TrackedFrame> frame_{"/tracker/frame"};
};

TEST_F(RegisterDepthTest, DepthIsFusedWithTheRightPixels) {
  // Until depth_image_proc has received the tf, and its output has come.
  int frame = 0;
  ASSERT_TRUE(spinUntil([&] {
    const auto tracked = frame_.at(send(frame++));
    return tracked && tracked->state == TrackedFrame::TRACKING && !tracked->depth_stamp.isZero();
  }));
  const auto mean = mean_.at(send(frame));
  ASSERT_TRUE(mean);
  EXPECT_EQ(mean->header.frame_id, camera_.frame_id);
  const cv::Mat_<float> depth = viewImage(mean);
  ASSERT_EQ(depth.size(), cv::Size(320, 240));
  int seen = 0;
  for (int x = 40; x < 300; ++x) {
    for (int y = 60; y < 180; ++y) {
      if (!(depth(y, x) > 0.0F)) continue;
      ++seen;
      ASSERT_NEAR(depth(y, x), camera_.depth(frame, x), 0.02F) << x << " " << y;
    }
  }
  EXPECT_GT(seen, 250 * 110);
  EXPECT_EQ(console_.count({"not registered"}), 0U);
}

}  // namespace
}  // namespace rgbd_sfm_fusion

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "register_depth_test");
  ros::NodeHandle handle;
  return RUN_ALL_TESTS();
}
