// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Topics of tracker and fusion are as docs/topics.md has them: type, encoding, unit, frame, stamp.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <geometry_msgs/PoseStamped.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_listener.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <set>

#include "live_test.h"
#include "rgbd_sfm_fusion/FusionStatistics.h"
#include "rgbd_sfm_fusion/Keyframe.h"
#include "rgbd_sfm_fusion/Scale.h"
#include "rgbd_sfm_fusion/TrackedFrame.h"
#include "rgbd_sfm_fusion/ros/odometry_messages.h"

namespace rgbd_sfm_fusion {
namespace {

using Image = sensor_msgs::Image;
using CameraInfo = sensor_msgs::CameraInfo;

/// All outputs.
struct Outputs {
  Inbox<TrackedFrame> frame{"/tracker/frame"};
  Inbox<Keyframe> keyframe{"/tracker/keyframe"};
  Inbox<Image> keyframe_image{"/tracker/keyframe/image"};
  Inbox<Image> keyframe_depth{"/tracker/keyframe/depth"};
  Inbox<Image> keyframe_variance{"/tracker/keyframe/variance"};
  Inbox<CameraInfo> keyframe_info{"/tracker/keyframe/camera_info"};
  Inbox<geometry_msgs::PoseStamped> keyframe_pose{"/tracker/keyframe/pose"};
  Inbox<geometry_msgs::PoseStamped> pose{"/tracker/pose"};
  Inbox<nav_msgs::Odometry> odometry{"/tracker/odometry"};
  Inbox<nav_msgs::Path> path{"/tracker/path"};
  Inbox<Image> mean{"/fusion/mean"};
  Inbox<Image> variance{"/fusion/variance"};
  Inbox<CameraInfo> info{"/fusion/camera_info"};
  Inbox<Image> standard_deviation{"/fusion/standard_deviation"};
  Inbox<Image> provenance{"/fusion/provenance"};
  Inbox<Image> provenance_color{"/fusion/provenance_color"};
  Inbox<Image> disagreement{"/fusion/disagreement"};
  Inbox<Image> sfm_depth{"/fusion/sfm_depth"};
  Inbox<Image> sfm_variance{"/fusion/sfm_variance"};
  Inbox<Scale> scale{"/fusion/scale"};
  Inbox<FusionStatistics> statistics{"/fusion/statistics"};
  Inbox<diagnostic_msgs::DiagnosticArray> diagnostics{"/diagnostics"};

  bool areConnected() const {
    return keyframe.isConnected() && frame.isConnected() && path.isConnected() && pose.isConnected() &&
           odometry.isConnected() && keyframe_image.isConnected() && keyframe_depth.isConnected() &&
           keyframe_variance.isConnected() && keyframe_info.isConnected() && keyframe_pose.isConnected() &&
           mean.isConnected() && variance.isConnected() && info.isConnected() &&
           standard_deviation.isConnected() && provenance.isConnected() && provenance_color.isConnected() &&
           disagreement.isConnected() && sfm_depth.isConnected() && sfm_variance.isConnected() &&
           scale.isConnected() && statistics.isConnected();
  }
};

class ContractTest : public ::testing::Test {
 protected:
  void SetUp() override {
    camera_.first_stamp = freshStamp();
    ASSERT_TRUE(live_camera_.waitForSubscribers());
    ASSERT_TRUE(spinUntil([this] { return outputs_.areConnected(); }));
    callReset();
  }

  /// Sends images one by one, each after the one before was fused. @return the last stamp
  Stamp sendFrames(int count, int first = 0) {
    Stamp stamp = kNoStamp;
    for (int frame = first; frame < first + count; ++frame) {
      stamp = live_camera_.send(camera_, frame);
      EXPECT_TRUE(outputs_.mean.at(stamp)) << "frame " << frame << " was not fused";
    }
    return stamp;
  }

  void expectImage(Inbox<Image>& inbox, Stamp stamp, const std::string& encoding) {
    const auto image = inbox.at(stamp);
    ASSERT_TRUE(image) << inbox.topic();
    EXPECT_EQ(image->encoding, encoding) << inbox.topic();
    EXPECT_EQ(image->header.frame_id, camera_.frame_id) << inbox.topic();
    EXPECT_EQ(image->width, 320U) << inbox.topic();
    EXPECT_EQ(image->height, 240U) << inbox.topic();
  }

  FakeCamera camera_;
  LiveCamera live_camera_;
  Outputs outputs_;
};

TEST_F(ContractTest, FusedImagesHaveTheEncodingSizeFrameAndStampOfTheContract) {
  camera_.hole = 0.4F;
  const Stamp stamp = sendFrames(12);
  for (auto* inbox : {&outputs_.mean, &outputs_.variance, &outputs_.standard_deviation, &outputs_.sfm_depth,
                      &outputs_.sfm_variance}) {
    expectImage(*inbox, stamp, "32FC1");
  }
  expectImage(outputs_.provenance, stamp, "mono8");
  expectImage(outputs_.disagreement, stamp, "mono8");
  expectImage(outputs_.provenance_color, stamp, "rgb8");
}

TEST_F(ContractTest, EveryFrameIsFusedOnce) {
  std::vector<Stamp> stamps;
  for (int frame = 0; frame < 30; ++frame) {
    stamps.push_back(live_camera_.send(camera_, frame));
    spinUntil([] { return false; }, 0.1);
  }
  ASSERT_TRUE(outputs_.mean.at(stamps.back()));
  const auto of = [&](const auto& inbox) {
    std::vector<Stamp> found;
    for (const auto& message : inbox.messages) found.push_back(fromRosTime(message->header.stamp));
    return found;
  };
  EXPECT_EQ(of(outputs_.mean), stamps);
  EXPECT_EQ(of(outputs_.frame), stamps);
}

TEST_F(ContractTest, FusedDepthIsInMetresWithAVarianceAndASource) {
  camera_.hole = 0.4F;
  const Stamp stamp = sendFrames(15);
  const cv::Mat_<float> mean = viewImage(outputs_.mean.at(stamp));
  const cv::Mat_<float> variance = viewImage(outputs_.variance.at(stamp));
  const cv::Mat_<float> sigma = viewImage(outputs_.standard_deviation.at(stamp));
  const cv::Mat_<std::uint8_t> provenance = viewImage(outputs_.provenance.at(stamp));
  int count[5] = {};
  std::vector<float> errors;
  for (int y = 0; y < mean.rows; ++y) {
    for (int x = 0; x < mean.cols; ++x) {
      ASSERT_LE(provenance(y, x), 4);
      ++count[provenance(y, x)];
      ASSERT_EQ(provenance(y, x) != 0, std::isfinite(mean(y, x)));
      if (provenance(y, x) == 0) continue;
      ASSERT_TRUE(std::isfinite(variance(y, x)) && variance(y, x) > 0.0F);
      ASSERT_FLOAT_EQ(sigma(y, x), std::sqrt(variance(y, x)));
      errors.push_back(std::abs(mean(y, x) / camera_.depth(14, x) - 1.0F));
    }
  }
  EXPECT_GT(count[1] + count[3], 320 * 240 / 2);
  ASSERT_FALSE(errors.empty());
  std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2),
                   errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.02F);
}

TEST_F(ContractTest, CameraInfoIsTheRectifiedCamera) {
  const Stamp stamp = sendFrames(1);
  for (auto* inbox : {&outputs_.info, &outputs_.keyframe_info}) {
    const auto info = inbox->at(stamp);
    ASSERT_TRUE(info) << inbox->topic();
    EXPECT_EQ(info->header.frame_id, camera_.frame_id);
    for (const double d : info->D) EXPECT_EQ(d, 0.0);
    EXPECT_EQ(rectifiedCamera(toCalibration(*info)), camera_.camera());
  }
}

TEST_F(ContractTest, ScaleAndStatisticsBelongToTheFrame) {
  const Stamp stamp = sendFrames(12);
  const auto scale = outputs_.scale.at(stamp);
  ASSERT_TRUE(scale);
  EXPECT_EQ(scale->header.frame_id, camera_.frame_id);
  EXPECT_FALSE(scale->refused);
  EXPECT_NEAR(scale->scale, 1.0, 0.1);
  EXPECT_GT(scale->standard_deviation, 0.0);
  EXPECT_GT(scale->inliers, 200U) << "scale_min_pixels";
  const auto statistics = outputs_.statistics.at(stamp);
  ASSERT_TRUE(statistics);
  EXPECT_NEAR(statistics->sensor_only + statistics->sfm_only + statistics->fused, 1.0, 1e-9);
  EXPECT_NEAR(statistics->total_sensor_only + statistics->total_sfm_only + statistics->total_fused, 1.0,
              1e-9);
  EXPECT_GT(statistics->total_pixels_with_depth, 10U * statistics->pixels_with_depth);
  EXPECT_EQ(statistics->skew, 0.0);
  EXPECT_TRUE(std::isfinite(statistics->latency));
}

TEST_F(ContractTest, TheFirstFrameIsItsOwnKeyframe) {
  const Stamp first = sendFrames(1);
  const auto frame = outputs_.frame.at(first);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->state, TrackedFrame::TRACKING);
  EXPECT_EQ(frame->header.frame_id, camera_.frame_id);
  EXPECT_EQ(fromRosTime(frame->keyframe_stamp), first);
  EXPECT_EQ(fromRosTime(frame->depth_stamp), first);
  EXPECT_EQ(frame->T_frame_keyframe.rotation.w, 1.0);
  EXPECT_EQ(frame->T_frame_keyframe.translation.x, 0.0);
}

TEST_F(ContractTest, TrackedFramesReferToTheirKeyframe) {
  const Stamp first = sendFrames(1);
  const Stamp stamp = sendFrames(3, 1);
  const auto frame = outputs_.frame.at(stamp);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->state, TrackedFrame::TRACKING);
  EXPECT_EQ(fromRosTime(frame->keyframe_stamp), first);
  EXPECT_EQ(frame->keyframe_revision, 2U) << "the map as of the frame before, just after a start";
  // p_frame = T p_keyframe: the camera went to +x, so points go to -x.
  EXPECT_NEAR(frame->T_frame_keyframe.translation.x, -3 * FakeCamera::kStep, 0.01);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_GT(frame->covariance[7 * i], 0.0);
    for (std::size_t j = 0; j < 6; ++j) {
      EXPECT_NEAR(frame->covariance[6 * i + j], frame->covariance[6 * j + i], 1e-9);
    }
  }
}

TEST_F(ContractTest, KeyframesComeWithEveryRefinementInProcessAndWithTheirImages) {
  const Stamp first = sendFrames(4);
  static_cast<void>(first);
  const Stamp keyframe_stamp = camera_.stamp(0);
  const auto keyframe = outputs_.keyframe.at(keyframe_stamp);
  ASSERT_TRUE(keyframe);
  EXPECT_EQ(keyframe->header.frame_id, camera_.frame_id);
  EXPECT_EQ(keyframe->K[0], camera_.camera().fx);
  EXPECT_EQ(keyframe->depth.encoding, "32FC1");
  EXPECT_EQ(keyframe->variance.encoding, "32FC1");
  std::set<std::uint32_t> revisions;
  spinUntil([&] {
    for (const auto& message : outputs_.keyframe.messages) {
      if (fromRosTime(message->header.stamp) == keyframe_stamp) revisions.insert(message->revision);
    }
    return revisions.size() >= 4;
  });
  EXPECT_EQ(revisions, (std::set<std::uint32_t>{0, 1, 2, 3}));
  expectImage(outputs_.keyframe_image, keyframe_stamp, "mono8");
  expectImage(outputs_.keyframe_depth, keyframe_stamp, "32FC1");
  expectImage(outputs_.keyframe_variance, keyframe_stamp, "32FC1");
  const auto pose = outputs_.keyframe_pose.at(keyframe_stamp);
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->header.frame_id, "odom");
}

TEST_F(ContractTest, PosesAreOfTheCameraInOdomWithTheFramesStamp) {
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

TEST_F(ContractTest, BothDepthEncodingsGiveTheSame) {
  const Stamp stamp = sendFrames(6);
  const auto integer = outputs_.mean.at(stamp);
  callReset();
  camera_.first_stamp = freshStamp();
  camera_.depth_encoding = "32FC1";
  const Stamp later = sendFrames(6);
  const auto floating = outputs_.mean.at(later);
  ASSERT_TRUE(integer && floating);
  EXPECT_EQ(integer->data, floating->data);
}

TEST_F(ContractTest, AllColourEncodingsGiveTheSame) {
  std::vector<sensor_msgs::ImageConstPtr> means;
  for (const char* encoding : {"rgb8", "bgr8", "mono8"}) {
    callReset();
    camera_.first_stamp = freshStamp();
    camera_.colour_encoding = encoding;
    means.push_back(outputs_.mean.at(sendFrames(6)));
    ASSERT_TRUE(means.back()) << encoding;
  }
  EXPECT_EQ(means[0]->data, means[1]->data);
  EXPECT_EQ(means[0]->data, means[2]->data);
}

TEST_F(ContractTest, ResetStartsANewRun) {
  const Stamp before = sendFrames(5);
  callReset();
  const Stamp stamp = sendFrames(1, 5);
  const auto old_frame = outputs_.frame.at(before);
  const auto frame = outputs_.frame.at(stamp);
  ASSERT_TRUE(old_frame && frame);
  EXPECT_EQ(frame->run, old_frame->run + 1);
  EXPECT_EQ(fromRosTime(frame->keyframe_stamp), stamp);
  EXPECT_EQ(outputs_.path.at(stamp)->poses.size(), 1U);
  EXPECT_EQ(outputs_.statistics.at(stamp)->total_pixels_with_depth,
            outputs_.statistics.at(stamp)->pixels_with_depth);
  EXPECT_NEAR(outputs_.pose.at(stamp)->pose.position.y, 0.0, 1e-9);
}

TEST_F(ContractTest, WithoutAParentOfTheImagesFrameTfGoesThere) {
  tf2_ros::Buffer buffer;
  tf2_ros::TransformListener listener(buffer);
  const Inbox<tf2_msgs::TFMessage> tf("/tf");  // shares the listener's subscription
  ASSERT_TRUE(spinUntil([&] { return tf.isConnected(); }));
  camera_.frame_id = "lonely_optical_frame";
  const Stamp stamp = sendFrames(4);
  ASSERT_TRUE(spinUntil([&] { return buffer.canTransform("odom", camera_.frame_id, toRosTime(stamp)); }));
  const SE3 T = fromTransform(buffer.lookupTransform("odom", camera_.frame_id, toRosTime(stamp)).transform);
  EXPECT_NEAR(T.translation().y(), -3 * FakeCamera::kStep, 0.01);
  const SE3 start =
      fromTransform(buffer.lookupTransform("odom", camera_.frame_id, toRosTime(camera_.stamp(0))).transform);
  EXPECT_LT((start.rotationMatrix() - opticalToBodyAxes().rotationMatrix()).norm(), 1e-9);
}

TEST_F(ContractTest, WithAParentTfGoesToTheBaseFrame) {
  geometry_msgs::TransformStamped mount;
  mount.header.frame_id = "camera_link";
  mount.child_frame_id = "mounted_optical_frame";
  mount.transform = toTransform(SE3(opticalToBodyAxes().rotation(), {0.1, 0.2, 0.3}));
  tf2_ros::StaticTransformBroadcaster broadcaster;
  broadcaster.sendTransform(mount);
  tf2_ros::Buffer buffer;
  tf2_ros::TransformListener listener(buffer);
  ASSERT_TRUE(
      spinUntil([&] { return buffer.canTransform("camera_link", "mounted_optical_frame", ros::Time(0)); }));
  spinUntil([] { return false; }, 0.5);  // the tracker, too, has to hear of it

  camera_.frame_id = "mounted_optical_frame";
  const Stamp stamp = sendFrames(4);
  ASSERT_TRUE(spinUntil([&] { return buffer.canTransform("odom", "camera_link", toRosTime(stamp)); }));
  const SE3 start =
      fromTransform(buffer.lookupTransform("odom", "camera_link", toRosTime(camera_.stamp(0))).transform);
  EXPECT_LT((start.rotationMatrix() - Eigen::Matrix3d::Identity()).norm(), 1e-9);
  EXPECT_LT(start.translation().norm(), 1e-9) << "odom is the base frame's pose at the start";
  const SE3 T = fromTransform(buffer.lookupTransform("odom", "camera_link", toRosTime(stamp)).transform);
  EXPECT_NEAR(T.translation().y(), -3 * FakeCamera::kStep, 0.01);
  EXPECT_NEAR(outputs_.pose.at(stamp)->pose.position.z, 0.3, 0.01) << "poses are of the camera";
}

TEST_F(ContractTest, OdometryOfTheBaseFrameIsAsFiltersReadIt) {
  const SE3 T_base_camera =
      SE3(Eigen::Quaterniond(Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitY())), {0.3, -0.1, 0.9}) *
      opticalToBodyAxes();
  geometry_msgs::TransformStamped mount;
  mount.header.frame_id = "camera_link";
  mount.child_frame_id = "tilted_optical_frame";
  mount.transform = toTransform(T_base_camera);
  tf2_ros::StaticTransformBroadcaster broadcaster;
  broadcaster.sendTransform(mount);
  tf2_ros::Buffer buffer;
  tf2_ros::TransformListener listener(buffer);
  ASSERT_TRUE(
      spinUntil([&] { return buffer.canTransform("camera_link", "tilted_optical_frame", ros::Time(0)); }));
  spinUntil([] { return false; }, 0.5);  // the tracker, too, has to hear of it
  camera_.frame_id = "tilted_optical_frame";

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
    ASSERT_TRUE(spinUntil([&] { return buffer.canTransform("odom", "camera_link", toRosTime(stamp)); }));
    const SE3 tf = fromTransform(buffer.lookupTransform("odom", "camera_link", toRosTime(stamp)).transform);
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

TEST_F(ContractTest, ImagesInABodyFrameAreSaidToBeAndSeenAlongItsXAxis) {
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

TEST_F(ContractTest, SettingsChangeAtRunTimeAndBadOnesAreRefused) {
  Console console;
  dynamic_reconfigure::Reconfigure call;
  dynamic_reconfigure::DoubleParameter range;
  range.name = "min_range";
  range.value = 3.0;
  call.request.config.doubles.push_back(range);
  ASSERT_TRUE(ros::service::call("/fusion/set_parameters", call));
  const Stamp stamp = sendFrames(1);
  EXPECT_EQ(outputs_.statistics.at(stamp)->pixels_with_depth, 0U) << "the wall is 2 m away";

  call.request.config.doubles[0].value = 0.4;
  ASSERT_TRUE(ros::service::call("/fusion/set_parameters", call));
  EXPECT_GT(outputs_.statistics.at(sendFrames(1, 1))->pixels_with_depth, 0U);

  dynamic_reconfigure::Reconfigure bad;
  dynamic_reconfigure::StrParameter estimator;
  estimator.name = "scale_estimator";
  estimator.value = "astrology";
  bad.request.config.strs.push_back(estimator);
  EXPECT_TRUE(spinUntil([&] {  // until this node has heard of the other's console, too
    return ros::service::call("/fusion/set_parameters", bad) &&
           console.count({"refused", "scale_estimator", "mean_ratio, least_squares or weighted_robust"}) > 0;
  }));
  std::map<std::string, std::string> shown;
  for (const auto& parameter : bad.response.config.strs) shown[parameter.name] = parameter.value;
  EXPECT_EQ(shown["scale_estimator"], "weighted_robust");
  sendFrames(2, 2);

  // NaN is in no range, but passes the server's own limits.
  dynamic_reconfigure::Reconfigure no_number;
  no_number.request.config.doubles = {range};
  no_number.request.config.doubles[0].value = std::numeric_limits<double>::quiet_NaN();
  for (const char* server : {"/fusion/set_parameters", "/tracker/set_parameters"}) {
    ASSERT_TRUE(ros::service::call(server, no_number));
    std::map<std::string, double> numbers;
    for (const auto& parameter : no_number.response.config.doubles) numbers[parameter.name] = parameter.value;
    EXPECT_NEAR(numbers["min_range"], 0.4, 1e-6) << server;
  }
  EXPECT_GT(outputs_.statistics.at(sendFrames(1, 4))->pixels_with_depth, 0U);
}

TEST_F(ContractTest, DiagnosticsTellRateDelayStateScaleAndShares) {
  std::set<std::string> keys, names;
  int frame = 0;
  EXPECT_TRUE(spinUntil([&] {
    sendFrames(1, frame++);
    for (const auto& array : outputs_.diagnostics.messages) {
      for (const auto& status : array->status) {
        names.insert(status.name);
        for (const auto& value : status.values) keys.insert(value.key);
      }
    }
    return keys.count("state") > 0 && keys.count("scale") > 0;
  }));
  EXPECT_TRUE(names.count("tracker: tracking") == 1 && names.count("fusion: fusion") == 1)
      << ::testing::PrintToString(names);
  for (const char* key : {"rate [Hz]", "delay [s]", "state", "scale", "share fused"}) {
    EXPECT_EQ(keys.count(key), 1U) << key;
  }
}

TEST_F(ContractTest, EachNodeHasItsOwnParametersOnly) {
  ros::NodeHandle handle;
  EXPECT_TRUE(handle.hasParam("/tracker/keyframe_distance"));
  EXPECT_FALSE(handle.hasParam("/tracker/rim_width"));
  EXPECT_TRUE(handle.hasParam("/fusion/rim_width"));
  EXPECT_FALSE(handle.hasParam("/fusion/keyframe_distance"));
  for (const char* node : {"/tracker/", "/fusion/"})
    EXPECT_TRUE(handle.hasParam(node + std::string("max_range")));
}

}  // namespace
}  // namespace rgbd_sfm_fusion

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "contract_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
