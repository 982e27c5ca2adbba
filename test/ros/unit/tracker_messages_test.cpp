// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/tracker_messages.h"

#include <gtest/gtest.h>
#include <boost/make_shared.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "rgbd_sfm_fusion/fusion/reprojection.h"
#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/stamp.h"

namespace rgbd_sfm_fusion {
namespace {

SE3 somePose() {
  Vector6 xi;
  xi << 0.1, -0.2, 0.3, 0.4, -0.5, 0.6;
  return SE3::exp(xi);
}

std_msgs::Header header() {
  std_msgs::Header header;
  header.stamp = ros::Time(5, 6);
  header.frame_id = "optical";
  return header;
}

TrackingResult someResult() {
  TrackingResult tracked;
  tracked.stamp = fromRosTime(header().stamp);
  tracked.state = TrackingState::kTracking;
  tracked.relocalised = true;
  tracked.keyframe_stamp = 3'000'000'007;
  tracked.keyframe_revision = 17;
  tracked.T_frame_keyframe = somePose();
  for (int i = 0; i < 36; ++i) tracked.covariance(i / 6, i % 6) = i / 3.0;
  tracked.T_first_frame = somePose() * somePose();
  tracked.share_of_good_points = 0.7;
  tracked.depth_delay = -0.012;
  return tracked;
}

KeyframeMap someKeyframe() {
  KeyframeMap keyframe;
  keyframe.stamp = 3'000'000'007;
  keyframe.revision = 17;
  keyframe.camera = {3, 2, 500.5, 501.5, 1.25, 0.75};
  keyframe.T_first_keyframe = somePose();
  keyframe.depth.mean = (cv::Mat_<float>(2, 3) << 1, NAN, 3, 4, 5, 6);
  keyframe.depth.variance = (cv::Mat_<float>(2, 3) << 0.1, NAN, 0.3, 0.4, 0.5, 0.6);
  return keyframe;
}

TEST(TrackerMessages, TrackedFrameSurvivesARoundTrip) {
  const TrackingResult tracked = someResult();
  const TrackedFrame message = toMessage(header(), tracked, 4'999'999'999);
  EXPECT_EQ(message.header.frame_id, "optical");
  EXPECT_EQ(message.state, TrackedFrame::TRACKING);
  EXPECT_EQ(fromRosTime(message.depth_stamp), 4'999'999'999);
  EXPECT_EQ(message.covariance[6 * 1 + 2], tracked.covariance(1, 2));

  const TrackingResult back = fromMessage(message);
  EXPECT_EQ(back.stamp, tracked.stamp);
  EXPECT_EQ(back.state, tracked.state);
  EXPECT_EQ(back.relocalised, tracked.relocalised);
  EXPECT_EQ(back.keyframe_stamp, tracked.keyframe_stamp);
  EXPECT_EQ(back.keyframe_revision, tracked.keyframe_revision);
  EXPECT_EQ(back.T_frame_keyframe.rotation().coeffs(), tracked.T_frame_keyframe.rotation().coeffs());
  EXPECT_EQ(back.T_frame_keyframe.translation(), tracked.T_frame_keyframe.translation());
  EXPECT_EQ(back.covariance, tracked.covariance);
  EXPECT_EQ(back.T_first_frame.translation(), tracked.T_first_frame.translation());
  EXPECT_EQ(back.share_of_good_points, tracked.share_of_good_points);
  EXPECT_EQ(back.depth_delay, tracked.depth_delay);
}

TEST(TrackerMessages, StatesHaveTheMessagesValues) {
  EXPECT_EQ(static_cast<int>(TrackingState::kInitialising), TrackedFrame::INITIALISING);
  EXPECT_EQ(static_cast<int>(TrackingState::kTracking), TrackedFrame::TRACKING);
  EXPECT_EQ(static_cast<int>(TrackingState::kLost), TrackedFrame::LOST);
}

TEST(TrackerMessages, WithoutDepthTheDepthStampIsZero) {
  EXPECT_TRUE(toMessage(header(), someResult(), kNoStamp).depth_stamp.isZero());
}

TEST(TrackerMessages, BadPosesAreRefusedOnlyWhereTheyCount) {
  TrackedFrame message = toMessage(header(), someResult(), kNoStamp);
  message.covariance[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(fromMessage(message), std::invalid_argument);
  message.covariance[0] = 1.0;
  EXPECT_NO_THROW(fromMessage(message));
  for (const double delay : {std::numeric_limits<double>::quiet_NaN(), 1e30}) {
    message.depth_delay = delay;
    EXPECT_THROW(fromMessage(message), std::invalid_argument) << delay;
  }
  message.state = TrackedFrame::LOST;
  EXPECT_EQ(fromMessage(message).state, TrackingState::kLost);
  message.state = 3;
  EXPECT_THROW(fromMessage(message), std::invalid_argument);
}

TEST(TrackerMessages, KeyframeSurvivesARoundTrip) {
  const KeyframeMap keyframe = someKeyframe();
  const KeyframePtr message = toMessage(header(), keyframe, SE3());
  EXPECT_EQ(fromRosTime(message->header.stamp), keyframe.stamp);
  EXPECT_EQ(message->header.frame_id, "optical");
  EXPECT_EQ(message->depth.header.stamp, message->header.stamp);
  EXPECT_EQ(message->depth.encoding, "32FC1");

  const KeyframeMap back = fromMessage(KeyframeConstPtr(message), SE3());
  EXPECT_EQ(back.stamp, keyframe.stamp);
  EXPECT_EQ(back.revision, keyframe.revision);
  EXPECT_EQ(back.camera, keyframe.camera);
  EXPECT_EQ(back.T_first_keyframe.translation(), keyframe.T_first_keyframe.translation());
  EXPECT_EQ(back.depth.mean(1, 2), 6.0F);
  EXPECT_TRUE(std::isnan(back.depth.mean(0, 1)));
  EXPECT_EQ(back.depth.variance(1, 0), 0.4F);
  EXPECT_EQ(back.depth.mean.data, message->depth.data.data()) << "copied";
}

TEST(TrackerMessages, KeyframePoseIsGivenInTheOdomFrame) {
  const KeyframePtr message = toMessage(header(), someKeyframe(), somePose());
  const SE3 expected = somePose() * someKeyframe().T_first_keyframe;
  EXPECT_EQ(fromTransform(message->T_odom_keyframe).translation(), expected.translation());
}

TEST(TrackerMessages, KeyframePoseComesBackInTheAxesOfTheFirstImage) {
  const KeyframeMap keyframe = someKeyframe();
  const SE3 T_odom_first = somePose() * somePose();
  const KeyframePtr message = toMessage(header(), keyframe, T_odom_first);
  // A frame that was tracked against this keyframe has its pose even without the message's odom frame.
  TrackingResult tracked = someResult();
  tracked.T_first_frame = keyframe.T_first_keyframe * tracked.T_frame_keyframe.inverse();
  const SE3 found = T_odom_firstOf(*message, tracked);
  EXPECT_LT((found.inverse() * T_odom_first).log().norm(), 1e-12);
  const KeyframeMap back = fromMessage(KeyframeConstPtr(message), found);
  EXPECT_LT((back.T_first_keyframe.inverse() * keyframe.T_first_keyframe).log().norm(), 1e-12);
}

/// Adds bytes to the end of each row of an image.
void pad(sensor_msgs::Image* image) {
  const std::size_t step = image->step, new_step = step + 12;
  std::vector<std::uint8_t> data(image->height * new_step, 0x7f);
  for (std::size_t row = 0; row < image->height; ++row)
    std::copy_n(&image->data[row * step], step, &data[row * new_step]);
  image->data = data;
  image->step = static_cast<std::uint32_t>(new_step);
}

TEST(TrackerMessages, KeyframeImagesMayHaveSomethingBetweenTheirRows) {
  KeyframeMap keyframe = someKeyframe();
  keyframe.camera = {160, 120, 150.0, 150.0, 79.5, 59.5};
  keyframe.depth.mean = cv::Mat_<float>(120, 160, 2.0F);
  for (int x = 0; x < 160; x += 3) keyframe.depth.mean.col(x).setTo(NAN);
  keyframe.depth.variance = keyframe.depth.mean * 1e-3F;
  const KeyframePtr message = toMessage(header(), keyframe, SE3());
  pad(&message->depth);
  pad(&message->variance);
  const KeyframeMap back = fromMessage(KeyframeConstPtr(message), SE3());
  const auto seen = [](const KeyframeMap& map) {
    const SE3 closer(Eigen::Quaterniond::Identity(), {0.02, 0.0, -0.5});
    GaussianDepth depth = reproject(map.depth, map.camera, closer, Matrix6::Zero(), {});
    cv::patchNaNs(depth.mean, -1.0);
    cv::patchNaNs(depth.variance, -1.0);
    return depth;
  };
  const GaussianDepth expected = seen(keyframe), frame = seen(back);
  EXPECT_GT(cv::countNonZero(expected.mean > 0.0), 5000);
  EXPECT_EQ(cv::norm(frame.mean, expected.mean, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(frame.variance, expected.variance, cv::NORM_INF), 0.0);
}

TEST(TrackerMessages, ContradictoryKeyframesAreRefused) {
  const auto refused = [](void (*damage)(Keyframe&)) {
    const KeyframePtr message = toMessage(header(), someKeyframe(), SE3());
    damage(*message);
    EXPECT_THROW(fromMessage(KeyframeConstPtr(message), SE3()), std::invalid_argument);
  };
  refused([](Keyframe& k) { k.depth.encoding = "16UC1"; });
  refused([](Keyframe& k) { k.variance.data.clear(); });
  refused([](Keyframe& k) { k.variance = sensor_msgs::Image(); });
  refused([](Keyframe& k) { k.K[0] = 0.0; });
  refused([](Keyframe& k) { k.K[4] = std::numeric_limits<double>::quiet_NaN(); });
  refused([](Keyframe& k) { k.T_odom_keyframe.rotation.w = std::numeric_limits<double>::quiet_NaN(); });
  refused([](Keyframe& k) {
    k.variance.width = 2;
    k.variance.step = 8;
    k.variance.data.resize(16);
  });
}

}  // namespace
}  // namespace rgbd_sfm_fusion
