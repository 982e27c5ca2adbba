// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Poses, odometry and tf are as docs/topics.md has them, wherever the images' frame hangs in tf.
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_listener.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <string>

#include "contract_fixture.h"
#include "rgbd_sfm_fusion/ros/odometry_messages.h"

namespace rgbd_sfm_fusion {
namespace {

class PosesTest : public ContractTest {
 protected:
  /// Images come from a frame that a robot has mounted on camera_link.
  void mountCamera(const std::string& frame_id, const SE3& T_base_camera) {
    geometry_msgs::TransformStamped mount;
    mount.header.frame_id = "camera_link";
    mount.child_frame_id = frame_id;
    mount.transform = toTransform(T_base_camera);
    broadcaster_.sendTransform(mount);
    ASSERT_TRUE(spinUntil([&] { return buffer_.canTransform("camera_link", frame_id, ros::Time(0)); }));
    spinUntil([] { return false; }, 0.5);  // the tracker, too, has to hear of it
    camera_.frame_id = frame_id;
  }

  tf2_ros::StaticTransformBroadcaster broadcaster_;
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_{buffer_};
};

TEST_F(PosesTest, PosesAreOfTheCameraInOdomWithTheFramesStamp) {
  const Stamp stamp = sendFrames(8);
  const auto pose = outputs_.pose.at(stamp);
  const auto odometry = outputs_.odometry.at(stamp);
  const auto path = outputs_.path.at(stamp);
  ASSERT_TRUE(pose && odometry && path);
  for (const std::string& frame_id :
       {pose->header.frame_id, odometry->header.frame_id, path->header.frame_id}) {
    EXPECT_EQ(frame_id, "odom");
  }
  EXPECT_EQ(odometry->child_frame_id, camera_.frame_id);
  EXPECT_EQ(path->poses.size(), 8U);
  // The camera slides to its right, which is -y of REP 103's axes.
  EXPECT_NEAR(pose->pose.position.y, -7 * FakeCamera::kStep, 0.015);
  EXPECT_NEAR(pose->pose.position.x, 0.0, 0.015);
  EXPECT_NEAR(odometry->pose.pose.position.y, pose->pose.position.y, 1e-12);
  EXPECT_GT(odometry->pose.covariance[0], 0.0);
}

TEST_F(PosesTest, WithoutAParentOfTheImagesFrameTfGoesThere) {
  const Inbox<tf2_msgs::TFMessage> tf("/tf");  // shares the listener's subscription
  ASSERT_TRUE(spinUntil([&] { return tf.isConnected(); }));
  camera_.frame_id = "lonely_optical_frame";
  const Stamp stamp = sendFrames(4);
  ASSERT_TRUE(spinUntil([&] { return buffer_.canTransform("odom", camera_.frame_id, toRosTime(stamp)); }));
  const SE3 T = fromTransform(buffer_.lookupTransform("odom", camera_.frame_id, toRosTime(stamp)).transform);
  EXPECT_NEAR(T.translation().y(), -3 * FakeCamera::kStep, 0.01);
  const SE3 start =
      fromTransform(buffer_.lookupTransform("odom", camera_.frame_id, toRosTime(camera_.stamp(0))).transform);
  EXPECT_LT((start.rotationMatrix() - opticalToBodyAxes().rotationMatrix()).norm(), 1e-9);
}

TEST_F(PosesTest, WithAParentTfGoesToTheBaseFrame) {
  mountCamera("mounted_optical_frame", SE3(opticalToBodyAxes().rotation(), {0.1, 0.2, 0.3}));
  const Stamp stamp = sendFrames(4);
  ASSERT_TRUE(spinUntil([&] { return buffer_.canTransform("odom", "camera_link", toRosTime(stamp)); }));
  const SE3 start =
      fromTransform(buffer_.lookupTransform("odom", "camera_link", toRosTime(camera_.stamp(0))).transform);
  EXPECT_LT((start.rotationMatrix() - Eigen::Matrix3d::Identity()).norm(), 1e-9);
  EXPECT_LT(start.translation().norm(), 1e-9) << "odom is the base frame's pose at the start";
  const SE3 T = fromTransform(buffer_.lookupTransform("odom", "camera_link", toRosTime(stamp)).transform);
  EXPECT_NEAR(T.translation().y(), -3 * FakeCamera::kStep, 0.01);
  EXPECT_NEAR(outputs_.pose.at(stamp)->pose.position.z, 0.3, 0.01) << "poses are of the camera";
}

TEST_F(PosesTest, OdometryOfTheBaseFrameIsAsFiltersReadIt) {
  const SE3 T_base_camera =
      SE3(Eigen::Quaterniond(Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitY())), {0.3, -0.1, 0.9}) *
      opticalToBodyAxes();
  mountCamera("tilted_optical_frame", T_base_camera);

  constexpr int kFrames = 15;
  sendFrames(kFrames);
  SE3 before;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int frame = 0; frame < kFrames; ++frame) {
    const Stamp stamp = camera_.stamp(frame);
    const auto odometry = outputs_.odometry.at(stamp);
    ASSERT_TRUE(odometry) << frame;
    EXPECT_EQ(odometry->header.frame_id, "odom");
    EXPECT_EQ(odometry->child_frame_id, "camera_link");
    geometry_msgs::Transform transform;
    transform.translation.x = odometry->pose.pose.position.x;
    transform.translation.y = odometry->pose.pose.position.y;
    transform.translation.z = odometry->pose.pose.position.z;
    transform.rotation = odometry->pose.pose.orientation;
    const SE3 pose = fromTransform(transform);
    ASSERT_TRUE(spinUntil([&] { return buffer_.canTransform("odom", "camera_link", toRosTime(stamp)); }));
    const SE3 tf = fromTransform(buffer_.lookupTransform("odom", "camera_link", toRosTime(stamp)).transform);
    EXPECT_LT((tf.inverse() * pose).log().norm(), 1e-9) << "what tf says";
    for (const auto* covariance : {&odometry->pose.covariance, &odometry->twist.covariance}) {
      const Matrix6 matrix = Eigen::Map<const Matrix6>(covariance->data());
      EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6>(matrix).eigenvalues().minCoeff(), 0.0) << frame;
    }
    if (frame > 0) {
      const auto& twist = odometry->twist.twist;
      Vector6 step;
      step << twist.linear.x, twist.linear.y, twist.linear.z, twist.angular.x, twist.angular.y,
          twist.angular.z;
      const SE3 predicted = before * SE3::exp(toSeconds(FakeCamera::kPeriod) * step);
      EXPECT_LT((predicted.inverse() * pose).log().norm(), 1e-6) << frame;
      sum += step.head<3>();
    }
    before = pose;
  }
  const Eigen::Vector3d velocity = T_base_camera.rotationMatrix() * Eigen::Vector3d::UnitX() *
                                   FakeCamera::kStep / toSeconds(FakeCamera::kPeriod);
  EXPECT_LT((sum / (kFrames - 1) - velocity).norm(), 0.1 * velocity.norm()) << "to the camera's right";

  camera_.contrast = 0.0;
  const Stamp lost = sendFrames(1, kFrames);
  ASSERT_EQ(outputs_.frame.at(lost)->state, TrackedFrame::LOST);
  spinUntil([] { return false; }, 0.3);
  for (const auto& message : outputs_.odometry.messages)
    EXPECT_LT(fromRosTime(message->header.stamp), lost) << "nothing while lost";
}

TEST_F(PosesTest, ImagesInABodyFrameAreSaidToBeAndSeenAlongItsXAxis) {
  Console console;
  camera_.frame_id = "camera_link";  // which Gazebo's plug-ins send if they have no frameName
  const Stamp stamp = sendFrames(4);
  const auto odometry = outputs_.odometry.at(stamp);
  ASSERT_TRUE(odometry);
  EXPECT_EQ(odometry->child_frame_id, "camera_link");
  EXPECT_NEAR(odometry->pose.pose.position.y, -3 * FakeCamera::kStep, 0.01) << "to the right";
  EXPECT_NEAR(odometry->pose.pose.orientation.w, 1.0, 0.01);
  EXPECT_TRUE(spinUntil([&] {  // until this node has heard of the other's console, too
    callReset();
    camera_.first_stamp = freshStamp();
    sendFrames(1);
    return console.count({"camera_link", "body's axes", "optical frame"}) > 0;
  }));
}

}  // namespace
}  // namespace rgbd_sfm_fusion

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "poses_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
