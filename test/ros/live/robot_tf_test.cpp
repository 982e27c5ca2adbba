// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// On a robot that has a tf tree and odometry of its own, which may come later than the camera's images:
///   odom -> base_link -> camera_link -> camera_rgb_optical_frame
/// No frame gets a second parent, and half a second later nothing of ours is in the robot's odom.
#include <geometry_msgs/PoseStamped.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <tf2_msgs/TFMessage.h>

#include <cmath>
#include <map>
#include <set>

#include "live_test.h"
#include "rgbd_sfm_fusion/ros/odometry_messages.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kGrace = 0.5;  // [s] of images after the robot's first transform

/// Every message that gives a position in a frame.
struct Poses {
  explicit Poses(const std::string& prefix)
      : pose(prefix + "/tracker/pose"),
        keyframe(prefix + "/tracker/keyframe/pose"),
        odometry(prefix + "/tracker/odometry"),
        path(prefix + "/tracker/path") {}

  bool areConnected() const {
    return pose.isConnected() && keyframe.isConnected() && odometry.isConnected() && path.isConnected();
  }
  /// Number of positions in a frame since a stamp.
  std::size_t count(const std::string& frame, Stamp since) const {
    return countOf(pose, frame, since) + countOf(keyframe, frame, since) + countOf(odometry, frame, since) +
           countOf(path, frame, since);
  }
  template <class Message>
  static std::size_t countOf(const Inbox<Message>& inbox, const std::string& frame, Stamp since) {
    return static_cast<std::size_t>(
        std::count_if(inbox.messages.begin(), inbox.messages.end(), [&](const auto& message) {
          return message->header.frame_id == frame && fromRosTime(message->header.stamp) >= since;
        }));
  }

  Inbox<geometry_msgs::PoseStamped> pose, keyframe;
  Inbox<nav_msgs::Odometry> odometry;
  Inbox<nav_msgs::Path> path;
};

/// The parents of frames on /tf since a stamp.
class Tree {
 public:
  Tree() {
    ros::NodeHandle handle;
    subscriber_ =
        handle.subscribe<tf2_msgs::TFMessage>("/tf", 1000, [this](const tf2_msgs::TFMessageConstPtr& m) {
          for (const auto& transform : m->transforms) transforms_.push_back(transform);
        });
  }
  std::map<std::string, std::set<std::string>> parents(Stamp since) const {
    std::map<std::string, std::set<std::string>> parents;
    for (const auto& transform : transforms_) {
      if (fromRosTime(transform.header.stamp) >= since)
        parents[transform.child_frame_id].insert(transform.header.frame_id);
    }
    return parents;
  }

 private:
  ros::Subscriber subscriber_;
  std::vector<geometry_msgs::TransformStamped> transforms_;
};

class Robot {
 public:
  void sendCamera() {
    geometry_msgs::TransformStamped mount;
    mount.header.frame_id = "camera_link";
    mount.child_frame_id = "camera_rgb_optical_frame";
    mount.transform = toTransform(opticalToBodyAxes());
    send(static_, {mount});
  }
  void send(Stamp stamp) {
    geometry_msgs::TransformStamped base, camera;
    base.header.stamp = camera.header.stamp = toRosTime(stamp);
    base.header.frame_id = "odom";
    base.child_frame_id = camera.header.frame_id = "base_link";
    camera.child_frame_id = "camera_link";
    base.transform = toTransform(SE3());
    camera.transform = toTransform(T_base_camera_link());
    send(moving_, {camera});  // not in the tree's order
    send(moving_, {base});
  }
  static SE3 T_base_camera_link() {
    return {Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY())), {0.3, -0.1, 0.9}};
  }

 private:
  static void send(const ros::Publisher& publisher, std::vector<geometry_msgs::TransformStamped> transforms) {
    tf2_msgs::TFMessage message;
    message.transforms = std::move(transforms);
    publisher.publish(message);
  }

  ros::NodeHandle handle_;
  ros::Publisher moving_ = handle_.advertise<tf2_msgs::TFMessage>("/tf", 100);
  ros::Publisher static_ = handle_.advertise<tf2_msgs::TFMessage>("/tf_static", 100, true);
};

TEST(RobotTf, OursStepsBackWhenTheRobotsComesThreeSecondsLate) {
  Poses ours(""), own("/own"), silent("/silent");
  Inbox<sensor_msgs::Image> mean("/fusion/mean"), own_mean("/own/fusion/mean"),
      silent_mean("/silent/fusion/mean");
  Console console;
  Tree tree;
  Robot robot;
  LiveCamera live_camera;
  FakeCamera camera;
  robot.sendCamera();
  ASSERT_TRUE(live_camera.waitForSubscribers());
  ASSERT_TRUE(spinUntil([&] {
    return ours.areConnected() && own.areConnected() && silent.areConnected() && mean.isConnected() &&
           own_mean.isConnected() && silent_mean.isConnected() && live_camera.colourSubscribers() >= 3 &&
           console.isConnected();
  }));
  spinUntil([] { return false; }, 0.5);  // /tf_static has to be heard of

  constexpr int kLate = 91;  // images: 3 s
  const Stamp late = camera.stamp(kLate), after = late + static_cast<Stamp>(1e9 * kGrace);
  const auto slide = [](int frame) { return frame % 60 < 30 ? frame % 30 : 30 - frame % 30; };  // to and fro
  std::size_t keyframes_until_then = 0;  // their poses have the keyframe's stamp, however late they are sent
  for (int frame = 0; frame < kLate + 45; ++frame) {
    FakeCamera there = camera;
    there.first_stamp = camera.stamp(frame) - slide(frame) * FakeCamera::kPeriod;
    if (frame >= kLate) robot.send(camera.stamp(frame));
    live_camera.send(there, slide(frame));
    for (auto* inbox : {&mean, &own_mean, &silent_mean}) ASSERT_TRUE(inbox->at(camera.stamp(frame))) << frame;
    if (camera.stamp(frame) < after) keyframes_until_then = ours.keyframe.messages.size();
  }
  spinUntil([] { return false; }, 0.5);

  const auto before = tree.parents(0), since = tree.parents(after);
  EXPECT_EQ(before.at("camera_link").count("odom"), 1U) << "published as long as nobody else does";
  for (const auto& [child, parents] : since) EXPECT_EQ(parents.size(), 1U) << child << " has two parents";
  EXPECT_EQ(since.at("camera_link"), std::set<std::string>{"base_link"});
  EXPECT_EQ(since.at("base_link"), std::set<std::string>{"odom"});
  EXPECT_GT(ours.count("odom", 0), 100U);
  EXPECT_EQ(ours.count("odom", after), 0U) << "in the robot's odom";
  EXPECT_GT(keyframes_until_then, 0U);
  EXPECT_EQ(ours.keyframe.messages.size(), keyframes_until_then) << "in the robot's odom";
  EXPECT_EQ(console.count({"moves frames in tf frame odom", "odom_frame:=visual_odom"}), 1U);

  // A tracker with an odom_frame of its own goes on with poses in it, but sends no tf, as base_link has a
  // parent.
  EXPECT_GT(own.count("visual_odom", after), 60U);
  EXPECT_GT(silent.count("silent_odom", after), 60U);
  EXPECT_EQ(console.count({"tf frame base_link has a parent already, odom", "no tf from visual_odom"}), 1U);
  EXPECT_EQ(since.count("visual_odom") + before.count("silent_odom"), 0U);
}

}  // namespace
}  // namespace rgbd_sfm_fusion

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "robot_tf_test");
  ros::NodeHandle handle;
  return RUN_ALL_TESTS();
}
