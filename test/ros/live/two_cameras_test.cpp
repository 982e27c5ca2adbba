// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// For two cameras, a launch file is included twice, in two namespaces. Each camera has its own topics, tf
/// frames, parameters and services.
#include <geometry_msgs/PoseStamped.h>
#include <tf2_msgs/TFMessage.h>

#include <map>
#include <set>

#include "live_test.h"
#include "rgbd_sfm_fusion/FusionStatistics.h"

namespace rgbd_sfm_fusion {
namespace {

struct Side {
  explicit Side(const std::string& name)
      : prefix(name),
        mean("/" + name + "/fusion/mean"),
        statistics("/" + name + "/fusion/statistics"),
        pose("/" + name + "/tracker/pose") {}

  std::string prefix;
  Inbox<sensor_msgs::Image> mean;
  Inbox<FusionStatistics> statistics;
  Inbox<geometry_msgs::PoseStamped> pose;
};

TEST(TwoCameras, EachIsFusedOnTopicsAndInFramesOfItsOwn) {
  Side left("left"), right("robot/right");
  Inbox<tf2_msgs::TFMessage> moving("/tf"), fixed("/tf_static");
  for (Side* side : {&left, &right}) {
    ASSERT_TRUE(
        spinUntil([&] { return side->mean.messages.size() >= 5 && side->pose.messages.size() >= 5; }, 60.0))
        << side->prefix;
    EXPECT_EQ(side->mean.messages.back()->header.frame_id, side->prefix + "/camera_rgb_optical_frame");
    EXPECT_EQ(side->pose.messages.back()->header.frame_id, side->prefix + "/odom");
    EXPECT_GT(side->statistics.messages.back()->pixels_with_depth, 100'000U);
  }
  ASSERT_TRUE(spinUntil([&] { return moving.messages.size() >= 4 && fixed.messages.size() >= 8; }));
  std::map<std::string, std::set<std::string>> parents;
  for (const auto* inbox : {&moving, &fixed}) {
    for (const auto& message : inbox->messages) {
      for (const auto& transform : message->transforms)
        parents[transform.child_frame_id].insert(transform.header.frame_id);
    }
  }
  for (const Side* side : {&left, &right}) {
    EXPECT_EQ(parents[side->prefix + "/camera_link"], std::set<std::string>{side->prefix + "/odom"});
    EXPECT_EQ(parents[side->prefix + "/camera_rgb_frame"],
              std::set<std::string>{side->prefix + "/camera_link"});
  }
  EXPECT_EQ(parents.size(), 10U) << "frames of two cameras, and nothing without a namespace";
}

TEST(TwoCameras, EachHasServicesAndParametersOfItsOwn) {
  for (const std::string prefix : {"/left", "/robot/right"}) {
    std_srvs::Trigger reset;
    ASSERT_TRUE(ros::service::waitForService(prefix + "/tracker/reset", ros::Duration(kPatience))) << prefix;
    EXPECT_TRUE(ros::service::call(prefix + "/tracker/reset", reset)) << prefix;
    EXPECT_TRUE(ros::service::exists(prefix + "/fusion/set_parameters", false)) << prefix;
    EXPECT_TRUE(ros::service::exists(prefix + "/camera/driver/set_parameters", false)) << prefix;
    EXPECT_TRUE(ros::param::has(prefix + "/tracker/keyframe_distance")) << prefix;
  }
  EXPECT_FALSE(ros::service::exists("/tracker/reset", false));
}

}  // namespace
}  // namespace rgbd_sfm_fusion

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "two_cameras_test");
  ros::NodeHandle handle;
  return RUN_ALL_TESTS();
}
