// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// A camera that turns and moves, with a calibration whose principal point is off.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "rgbd_sfm_fusion/odometry/self_calibration.h"
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"
#include "synthetic_views.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kInterval = 1.0 / 30.0;  // [s]
constexpr int kFrames = 120;

/// A hand that looks around.
SE3 T_camera_world(double time) {
  return motion(0.15 * std::sin(1.7 * time), 0.1 * std::sin(2.3 * time), 0.08 * std::sin(1.3 * time),
                0.12 * std::sin(2.9 * time), 0.2 * std::sin(2.1 * time), 0.1 * std::sin(1.9 * time));
}

/// @param depth_until  number of the first frame whose depth image has no depth
std::vector<TrackingResult> track(const Eigen::Vector2d& off, bool estimate, int depth_until = kFrames) {
  const PlaneScene scene(smallCamera());
  PinholeCamera given = scene.camera();
  given.cx += off.x(), given.cy += off.y();
  OdometryOptions options;
  options.tracking.pyramid_levels = 4;
  options.estimate_readout = false;
  options.estimate_principal_point = estimate;
  VisualOdometry odometry(given, options);
  std::vector<TrackingResult> results;
  for (int i = 0; i < kFrames; ++i) {
    const double time = i * kInterval;
    RgbdFrame frame =
        scene.frame(fromSeconds(1.0 + time), T_camera_world(time), 2.0, static_cast<std::uint64_t>(i) + 1);
    if (i >= depth_until) frame.depth = DepthImage(frame.depth.size(), 0.0F);
    results.push_back(odometry.track(frame));
    odometry.map();
  }
  return results;
}

/// Root mean square error of the motion over a second, in the last second.
double motionError(const std::vector<TrackingResult>& results) {
  double sum = 0.0;
  for (int i = kFrames - 30; i < kFrames; ++i) {
    const auto &now = results[static_cast<std::size_t>(i)],
               &before = results[static_cast<std::size_t>(i) - 30];
    const SE3 T_now_before = now.T_first_frame.inverse() * before.T_first_frame;
    const SE3 truth = T_camera_world(i * kInterval) * T_camera_world((i - 30) * kInterval).inverse();
    sum += (T_now_before * truth.inverse()).log().squaredNorm();
  }
  return std::sqrt(sum / 30.0);
}

/// NEES / 6 of the poses relative to their keyframes, in the last second.
double relativeNees(const std::vector<TrackingResult>& results) {
  double sum = 0.0;
  int count = 0;
  for (int i = kFrames - 30; i < kFrames; ++i) {
    const TrackingResult& now = results[static_cast<std::size_t>(i)];
    if (now.keyframe_stamp == now.stamp) continue;
    const SE3 T_keyframe_world = T_camera_world(toSeconds(now.keyframe_stamp) - 1.0);
    const Vector6 error =
        (now.T_frame_keyframe * T_keyframe_world * T_camera_world(i * kInterval).inverse()).log();
    sum += error.dot(now.covariance.ldlt().solve(error)) / 6.0;
    ++count;
  }
  return sum / count;
}

TEST(PrincipalPoint, ThatIsOffIsFoundAndPosesGain) {
  const Eigen::Vector2d off(5.0, 5.0);
  const std::vector<TrackingResult> learned = track(off, true);
  const TrackingResult& last = learned.back();
  for (int i = 0; i < 2; ++i) {
    EXPECT_LT(std::abs(last.principal_point_correction(i) + off(i)), 3.0 * last.principal_point_sigma(i));
    EXPECT_LT(last.principal_point_sigma(i), 2.0);
  }
  EXPECT_LT((last.principal_point_correction + off).norm(), 0.5 * off.norm());
  EXPECT_NE(remarkOnCalibration(last), "");
  EXPECT_LT(relativeNees(learned), 3.0);
  const double ignored = motionError(track(off, false)), with = motionError(learned);
  EXPECT_LT(with, 0.7 * ignored) << with << " of " << ignored;
}

TEST(PrincipalPoint, ThatBecomesClearWithoutSensorDepthLosesNoFrame) {
  const std::vector<TrackingResult> learned = track({5.0, 5.0}, true, 40);
  const auto clear = std::find_if(learned.begin(), learned.end(), [](const TrackingResult& result) {
    return !result.principal_point_correction.isZero();
  });
  ASSERT_GT(clear - learned.begin(), 40);
  ASSERT_NE(clear, learned.end());
  for (const TrackingResult& result : learned)
    EXPECT_EQ(result.state, TrackingState::kTracking) << toSeconds(result.stamp);
}

TEST(PrincipalPoint, OfARightCalibrationIsLeftAlone) {
  const std::vector<TrackingResult> fixed = track({0.0, 0.0}, false), learned = track({0.0, 0.0}, true);
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    EXPECT_EQ(learned[i].principal_point_correction, Eigen::Vector2d(0.0, 0.0)) << i;
    EXPECT_EQ(fixed[i].T_frame_keyframe.log(), learned[i].T_frame_keyframe.log()) << i;
  }
  EXPECT_GT(learned.front().principal_point_sigma.x(), 2.0) << "the camera did not move yet";
  EXPECT_LT(learned.back().principal_point_sigma.norm(), 0.5);
  EXPECT_EQ(remarkOnCalibration(learned.back()), "");
  EXPECT_EQ(fixed.back().principal_point_sigma, Eigen::Vector2d(0.0, 0.0)) << "nothing is learned";
}

/// Sum of what the calibration adds to the covariance of a motion over a second, which goes from keyframe to
/// keyframe with `keyframes` of them in the second.
Matrix6 ofMotion(const SE3& each, int keyframes, bool estimate) {
  OdometryOptions options;
  options.estimate_readout = false;
  options.estimate_principal_point = estimate;
  SelfCalibration calibration(smallCamera(), options);
  const PlaneScene scene(smallCamera());
  ImagePyramid image;
  image.build(scene.frame(1, SE3(), 2.0, 1).grey, 3, {});
  AlignmentResult aligned;
  aligned.T_frame_keyframe = each;
  Matrix6 sum = Matrix6::Zero();
  for (int i = 0; i < 2 * keyframes; ++i) {
    KeyframeToTrack keyframe;
    keyframe.stamp = fromSeconds(1.0 + i / (keyframes + 0.001));
    calibration.observe({keyframe.reference, image, options.tracking, {}, {}, {}}, aligned, keyframe, Step());
    if (i < keyframes) continue;  // the second before
    const Matrix6 Ad = each.adjoint();
    sum = Ad * sum * Ad.transpose() + calibration.covariance(aligned, keyframe, Step());
  }
  return sum;
}

TEST(PrincipalPoint, AndALensThatIsNotStraightTurnTheAxesOfAllPosesAlike) {
  Vector6 twist, turned = Vector6::Zero();
  twist << 0.05, 0.02, 0.0, 0.2, -0.1, 0.05;
  turned.segment<2>(3) = Eigen::Vector2d(0.012, -0.012);  // [rad] of the camera's axes
  for (const int keyframes : {1, 3, 6}) {
    const SE3 each = SE3::exp(twist / keyframes), whole = SE3::exp(twist);
    const Vector6 error = turned - whole.adjoint() * turned;
    Matrix6 covariance = ofMotion(each, keyframes, true);
    EXPECT_TRUE(ofMotion(each, keyframes, false).isZero()) << "as calibrated";
    covariance.diagonal().array() += 1e-10;
    EXPECT_LT(error.dot(covariance.ldlt().solve(error)) / 2.0, 1.2) << keyframes;  // two angles
    EXPECT_GT(error.dot(covariance.ldlt().solve(error)) / 2.0, 0.3) << keyframes;
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
