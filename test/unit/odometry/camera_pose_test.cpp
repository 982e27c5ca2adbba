// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/camera_pose.h"

#include <gtest/gtest.h>

namespace rgbd_sfm_fusion {
namespace {

double nees(const Vector6& error, const Matrix6& covariance) {
  return error.dot(covariance.ldlt().solve(error)) / 6.0;
}

TEST(PoseCovariance, CoversAWrongScaleOfTheKeyframe) {
  AlignmentResult aligned;
  aligned.covariance = 1e-9 * Matrix6::Identity();
  for (const Eigen::Vector3d& t : {Eigen::Vector3d(0.2, 0.0, 0.0), Eigen::Vector3d(-0.1, 0.2, 0.05)}) {
    aligned.T_frame_keyframe = SE3(Eigen::Quaterniond::Identity(), t);
    Vector6 by_scale = Vector6::Zero();
    by_scale.head<3>() = 0.007 * t;
    EXPECT_LT(nees(by_scale, poseCovariance(aligned, 0.005)), 1.0);
    EXPECT_GT(nees(by_scale, aligned.covariance), 100.0);
    // A roll, which the scale does not explain, is as certain as before.
    Vector6 roll = Vector6::Zero();
    roll(5) = 1e-3;
    EXPECT_GT(nees(roll, poseCovariance(aligned, 0.005)), 100.0);
  }
}

TEST(PoseCovariance, IsThatOfAlignmentWhereTheCameraStandsStill) {
  AlignmentResult aligned;
  aligned.covariance = 1e-6 * Matrix6::Identity();
  EXPECT_EQ(poseCovariance(aligned, 0.005), aligned.covariance);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
