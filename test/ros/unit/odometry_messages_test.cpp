// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Odometry as a filter reads it. The pose is that of child_frame_id in frame_id; its covariance is about the
/// position itself, in the axes of frame_id. The twist is in the axes of child_frame_id.
#include "rgbd_sfm_fusion/ros/odometry_messages.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <vector>

#include "rgbd_sfm_fusion/ros/stamp.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr Stamp kPeriod = 33'000'000;  // [ns]

SE3 motion(double x, double y, double z, double rx, double ry, double rz) {
  Vector6 xi;
  xi << x, y, z, rx, ry, rz;
  return SE3::exp(xi);
}

/// Cameras on a robot: with the base's own axes, looking ahead; looking down from a mast; at its side, far
/// out.
std::vector<OdomPlace> places() {
  const SE3 ahead = opticalToBodyAxes();
  const SE3 pitched =
      SE3(Eigen::Quaterniond::Identity(), {0.3, -0.1, 0.9}) * motion(0, 0, 0, 0, 0.7, 0) * ahead;
  const SE3 rolled = motion(-2.0, 1.5, 0.4, 1.2, -0.3, 2.8) * ahead;
  std::vector<OdomPlace> places;
  for (const SE3& T_base_camera : {SE3(), ahead, pitched, rolled})
    places.push_back({"odom", "base_link", T_base_camera, T_base_camera});
  return places;
}

/// A covariance with correlations.
Matrix6 someCovariance(double size) {
  Matrix6 root;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) root(i, j) = size * std::sin(1.0 + 3.7 * i + 5.3 * j + i * j);
  }
  return root * root.transpose() + 1e-3 * size * size * Matrix6::Identity();
}

/// Result for a camera that turns and moves at once, against one keyframe.
TrackingResult tracked(int frame) {
  TrackingResult result;
  result.stamp = 1'000'000'000 + frame * kPeriod;
  result.state = TrackingState::kTracking;
  result.T_first_frame =
      motion(0.02 * frame, -0.01 * frame, 0.03, 0.004 * frame, 0.03 * frame, -0.01 * frame);
  result.T_frame_keyframe = result.T_first_frame.inverse();
  result.covariance = someCovariance(1e-3);
  result.pose_covariance = result.covariance;
  return result;
}

/// A message as a filter reads it, without the conversions under test.
struct Read {
  Eigen::Vector3d position, velocity, rotation_rate;
  Eigen::Matrix3d rotation;
  Matrix6 pose_covariance, twist_covariance;

  explicit Read(const nav_msgs::Odometry& message) {
    const auto& p = message.pose.pose.position;
    const auto& q = message.pose.pose.orientation;
    const auto& twist = message.twist.twist;
    position = {p.x, p.y, p.z};
    rotation = Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix();
    velocity = {twist.linear.x, twist.linear.y, twist.linear.z};
    rotation_rate = {twist.angular.x, twist.angular.y, twist.angular.z};
    for (int i = 0; i < 36; ++i) {
      pose_covariance(i / 6, i % 6) = message.pose.covariance[static_cast<std::size_t>(i)];
      twist_covariance(i / 6, i % 6) = message.twist.covariance[static_cast<std::size_t>(i)];
    }
  }

  Vector6 twist() const {
    Vector6 both;
    both << velocity, rotation_rate;
    return both;
  }
};

Read read(const OdomPlace& place, const TrackingResult& now,
          const std::optional<TrackingResult>& before = {}) {
  return Read(toOdometryMessage({}, place, now, velocityOf(now, before)));
}

/// The motion from one pose to another, in the axes of odom and about the position itself.
Vector6 difference(const Read& from, const Read& to) {
  const Eigen::AngleAxisd turn(to.rotation * from.rotation.transpose());
  Vector6 both;
  both << to.position - from.position, turn.angle() * turn.axis();
  return both;
}

void expectRegular(const Matrix6& covariance) {
  EXPECT_EQ(covariance, covariance.transpose());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6>(covariance).eigenvalues().minCoeff(), 0.0);
}

double relativeDifference(const Matrix6& found, const Matrix6& expected) {
  return (found - expected).norm() / expected.norm();
}

TEST(OdometryMessages, BodyAxesAreThoseOfRep103) {
  const SE3 T = opticalToBodyAxes();
  EXPECT_LT((T * Eigen::Vector3d(0, 0, 1) - Eigen::Vector3d(1, 0, 0)).norm(), 1e-15) << "forward";
  EXPECT_LT((T * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(0, -1, 0)).norm(), 1e-15) << "right";
  EXPECT_LT((T * Eigen::Vector3d(0, 1, 0) - Eigen::Vector3d(0, 0, -1)).norm(), 1e-15) << "down";
}

TEST(OdometryMessages, ABodysAxesAreKnownByTfAndName) {
  const SE3 mount(Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY())), {0.1, 0.2, 0.3});
  EXPECT_TRUE(hasBodyAxes("camera_link", "camera_link", std::nullopt));
  EXPECT_TRUE(hasBodyAxes("head_camera", "base_link", mount)) << "pitched, but looking ahead along x";
  EXPECT_FALSE(hasBodyAxes("head_camera", "base_link", std::nullopt)) << "nothing is known";
  EXPECT_FALSE(hasBodyAxes("head_camera", "base_link", mount * opticalToBodyAxes()));
  EXPECT_FALSE(hasBodyAxes("up_optical_frame", "base_link", SE3())) << "a camera that looks up";
  EXPECT_FALSE(hasBodyAxes("", "", std::nullopt));
}

TEST(OdometryMessages, AreOfTheBaseFrameInOdomAtTheImagesTime) {
  std_msgs::Header header;
  header.frame_id = "camera_rgb_optical_frame";
  header.stamp = ros::Time(12, 34);
  const OdomPlace place = places()[2];
  TrackingResult start = tracked(0);
  start.T_first_frame = SE3();
  const nav_msgs::Odometry message = toOdometryMessage(header, place, start, velocityOf(start, {}));
  EXPECT_EQ(message.header.frame_id, "odom");
  EXPECT_EQ(message.header.stamp, header.stamp);
  EXPECT_EQ(message.child_frame_id, "base_link");
  EXPECT_LT(Read(message).position.norm(), 1e-12) << "odom is the base frame's pose at the start";
  EXPECT_LT((Read(message).rotation - Eigen::Matrix3d::Identity()).norm(), 1e-12);
}

TEST(OdometryMessages, TwistLeadsFromOnePoseToTheNext) {
  for (const OdomPlace& place : places()) {
    for (int frame = 1; frame < 12; ++frame) {
      const Read before = read(place, tracked(frame - 1)),
                 now = read(place, tracked(frame), tracked(frame - 1));
      Eigen::Vector3d position = before.position;
      Eigen::Matrix3d rotation = before.rotation;
      const int steps = 10000;
      const double time = toSeconds(kPeriod) / steps;
      const Eigen::Vector3d turn = now.rotation_rate * time;
      const Eigen::Matrix3d small = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
      for (int i = 0; i < steps; ++i) {
        position += rotation * now.velocity * time;
        rotation = rotation * small;
      }
      EXPECT_LT((position - now.position).norm(), 1e-6) << frame;
      EXPECT_LT((rotation - now.rotation).norm(), 1e-6) << frame;
    }
  }
}

TEST(OdometryMessages, ACameraThatTurnsAboutTheBaseMakesNoVelocityOfTheBase) {
  const OdomPlace place = places()[2];
  TrackingResult before = tracked(0), now = tracked(1);
  const SE3 turn(Eigen::Quaterniond(Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitZ())),
                 Eigen::Vector3d::Zero());
  before.T_first_frame = SE3();
  now.T_first_frame = place.T_base_camera.inverse() * turn * place.T_base_camera;
  EXPECT_GT(now.T_first_frame.translation().norm(), 0.01) << "the camera itself moves";
  const Read message = read(place, now, before);
  EXPECT_LT(message.velocity.norm(), 1e-12);
  EXPECT_LT((message.rotation_rate - Eigen::Vector3d(0, 0, 0.05 / toSeconds(kPeriod))).norm(), 1e-9);
}

TEST(OdometryMessages, PoseCovarianceIsThatOfPerturbedPoses) {
  constexpr double kStep = 1e-6;
  for (const OdomPlace& place : places()) {
    const TrackingResult estimate = tracked(9);
    const Read message = read(place, estimate);
    Matrix6 jacobian;
    for (int i = 0; i < 6; ++i) {
      TrackingResult other = estimate;  // TrackingResult: left perturbation of the inverse, axes of the frame
      const SE3 T_frame_first = SE3::exp(kStep * Vector6::Unit(i)) * estimate.T_first_frame.inverse();
      other.T_first_frame = T_frame_first.inverse();
      jacobian.col(i) = difference(message, read(place, other)) / kStep;
    }
    const Matrix6 expected = jacobian * estimate.pose_covariance * jacobian.transpose();
    EXPECT_LT(relativeDifference(message.pose_covariance, expected), 1e-4);
    expectRegular(message.pose_covariance);
  }
}

TEST(OdometryMessages, TwistCovarianceIsThatOfPerturbedPoses) {
  constexpr double kStep = 1e-6;
  for (const OdomPlace& place : places()) {
    const TrackingResult before = tracked(8), estimate = tracked(9);
    const Read message = read(place, estimate, before);
    const Matrix6 change = Read(toOdometryMessage({}, place, estimate,
                                                  [&] {
                                                    TrackingResult exact = before, exact_now = estimate;
                                                    exact.covariance = exact.pose_covariance =
                                                        exact_now.pose_covariance = Matrix6::Zero();
                                                    return velocityOf(exact_now, exact);
                                                  }()))
                               .twist_covariance;
    // Both have errors of their own against the keyframe. That has none, as odom begins there.
    Matrix6 expected = change;
    for (const bool moves_before : {true, false}) {
      Matrix6 jacobian;
      for (int i = 0; i < 6; ++i) {
        TrackingResult other_before = before, other = estimate;
        TrackingResult& moved = moves_before ? other_before : other;
        moved.T_first_frame = (SE3::exp(kStep * Vector6::Unit(i)) * moved.T_first_frame.inverse()).inverse();
        jacobian.col(i) = (read(place, other, other_before).twist() - message.twist()) / kStep;
      }
      expected += jacobian * before.covariance * jacobian.transpose();
    }
    // To first order in the motion between two frames.
    EXPECT_LT(relativeDifference(message.twist_covariance, expected), 0.05);
    expectRegular(message.twist_covariance);
  }
}

TEST(OdometryMessages, WhatIsKnownOfTheKeyframeIsNoUncertaintyOfTheVelocity) {
  TrackingResult before = tracked(8), now = tracked(9);
  const Read fresh = read(places()[2], now, before);
  const Matrix6 drift = someCovariance(0.5);  // the keyframe's error, which each frame inherits
  for (TrackingResult* result : {&before, &now}) {
    const Matrix6 Ad = result->T_frame_keyframe.adjoint();
    result->pose_covariance += Ad * drift * Ad.transpose();
  }
  const Read drifted = read(places()[2], now, before);
  EXPECT_LT(relativeDifference(drifted.twist_covariance, fresh.twist_covariance), 1e-6);
  EXPECT_GT(drifted.pose_covariance(0, 0), 10.0 * fresh.pose_covariance(0, 0));
}

TEST(OdometryMessages, ANewKeyframeChangesNothingInTheVelocity) {
  const TrackingResult before = tracked(8), now = tracked(9);
  TrackingResult keyframe = now;  // tracked as `now`, then made the keyframe: it names itself
  keyframe.keyframe_stamp = keyframe.stamp;
  keyframe.T_frame_keyframe = SE3();
  keyframe.covariance = 1e-12 * Matrix6::Identity();
  EXPECT_EQ(read(places()[1], keyframe, before).twist_covariance,
            read(places()[1], now, before).twist_covariance);

  TrackingResult next = tracked(10);
  const Matrix6 Ad = (next.T_first_frame.inverse() * keyframe.T_first_frame).adjoint();
  next.pose_covariance = Ad * keyframe.pose_covariance * Ad.transpose() + next.covariance;
  const Matrix6 after = read(places()[0], next, keyframe).twist_covariance;
  EXPECT_LT(after.trace(), 0.9 * read(places()[0], tracked(10), before).twist_covariance.trace())
      << "only one of the two poses has an error";
  expectRegular(after);
}

TEST(OdometryMessages, WithoutAFrameBeforeAGapOrAJumpNothingIsKnownOfTheVelocity) {
  TrackingResult late = tracked(9);
  late.stamp = tracked(8).stamp + 400'000'000;
  TrackingResult jumped = tracked(9);
  jumped.relocalised = true;
  TrackingResult back = tracked(9);
  back.stamp = tracked(8).stamp;
  for (const Read& message : {read(places()[2], tracked(9)), read(places()[2], late, tracked(8)),
                              read(places()[2], jumped, tracked(8)), read(places()[2], back, tracked(8))}) {
    EXPECT_EQ(message.twist().norm(), 0.0);
    for (int i = 0; i < 6; ++i) EXPECT_GE(std::sqrt(message.twist_covariance(i, i)), 10.0 - 1e-9) << i;
    expectRegular(message.twist_covariance);
  }
}

TEST(OdometryMessages, ALossEndsTheMotion) {
  VelocityEstimator velocities;
  TrackingResult lost;
  lost.stamp = tracked(2).stamp;
  lost.state = TrackingState::kLost;
  EXPECT_EQ(velocities.next(tracked(0)).twist.norm(), 0.0);
  EXPECT_GT(velocities.next(tracked(1)).twist.norm(), 0.1);
  velocities.next(lost);
  EXPECT_EQ(velocities.next(tracked(3)).twist.norm(), 0.0);
  EXPECT_GT(velocities.next(tracked(4)).twist.norm(), 0.1);
  velocities.restart();
  EXPECT_EQ(velocities.next(tracked(5)).twist.norm(), 0.0);
}

TEST(OdometryMessages, CovariancesStayRegularWhereTrackingKnowsAlmostEverythingOrAlmostNothing) {
  for (const OdomPlace& place : places()) {
    for (const double variance : {1e-12, 1e-6, 1.0, 1e4}) {
      TrackingResult before = tracked(8), now = tracked(9);
      before.covariance = now.covariance = 1e-12 * Matrix6::Identity();
      const Matrix6 Ad = (now.T_first_frame.inverse() * before.T_first_frame).adjoint();
      before.pose_covariance = variance * Matrix6::Identity();
      now.pose_covariance = Ad * before.pose_covariance * Ad.transpose() + now.covariance;
      const Read message = read(place, now, before);
      expectRegular(message.pose_covariance);
      expectRegular(message.twist_covariance);
    }
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
