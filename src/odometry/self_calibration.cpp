// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/self_calibration.h"

#include <algorithm>
#include <cmath>

#include "rgbd_sfm_fusion/tools/text_format.h"

namespace rgbd_sfm_fusion {
namespace {

// Of the focal length: principal points that differ by more contradict each other. At the image's sides,
// depth is half a per cent off where the camera turns by as much as it moves round the scene.
constexpr double kOtherPrincipalPoint = 0.004;
constexpr double kOver = 1.0;  // [s] covariances of relative poses are right over this time

}  // namespace

SelfCalibration::SelfCalibration(const PinholeCamera& camera, const OdometryOptions& options)
    : given_(camera), shutter_(options), principal_point_(camera) {
  setOptions(options);
}

void SelfCalibration::reset(const OdometryOptions& options) {
  shutter_.reset(options);
  principal_point_ = PrincipalPointEstimator(given_);
  depth_delay_ = DepthDelayEstimator();
  keyframes_.clear();
}

void SelfCalibration::setOptions(const OdometryOptions& options) {
  learns_readout_ = options.estimate_readout;
  learns_principal_point_ = options.estimate_principal_point;
  learns_depth_delay_ = options.estimate_depth_delay && options.compensate_skew && options.feedsBack();
  if (!learns_depth_delay_) depth_delay_.forgetLast();
  shutter_.setOptions(options);
}

void SelfCalibration::observe(const AlignmentProblem& problem, const AlignmentResult& aligned,
                              const KeyframeToTrack& keyframe, const Step& step) {
  shutter_.observe(step);
  if (keyframes_.empty() || keyframes_.back() != keyframe.stamp) keyframes_.push_back(keyframe.stamp);
  while (toSeconds(keyframe.stamp - keyframes_.front()) > kOver) keyframes_.pop_front();
  if (!step.isKnown() || !keyframe.step.isKnown()) {
    depth_delay_.forgetLast();
    return;
  }
  if (learns_depth_delay_)
    depth_delay_.observe(aligned, step.twist, step.interval,
                         {keyframe.stamp, keyframe.step.velocity(), keyframe.depth_delay});
  if (!learns_readout_ && !learns_principal_point_) return;
  const CalibrationEquations equations =
      calibrationEquations(problem, aligned, keyframe.step.during(step.interval));
  if (learns_readout_)
    shutter_.observe(equations, keyframe.stamp, problem.shutter.readout * step.interval, step.interval);
  if (learns_principal_point_)
    principal_point_.observe(equations, keyframe.stamp,
                             {keyframe.camera.cx - given_.cx, keyframe.camera.cy - given_.cy},
                             shutter_.readoutSigma() / step.interval);
}

Matrix6 SelfCalibration::covariance(const AlignmentResult& aligned, const Place& keyframe,
                                    const Step& step) const {
  const Matrix6 of_shutter =
      shutter_.covariance(aligned, step, keyframe.reference_readout_time, keyframe.step);
  if (!learns_principal_point_) return of_shutter;
  const Matrix6 of_camera = of_shutter + covarianceByAxes(aligned.T_frame_keyframe);
  const bool is_observed = step.isKnown() && keyframe.step.isKnown();  // as in observe()
  if (!is_observed || principal_point_.belief().correction().isZero()) return of_camera;
  const Eigen::Matrix<double, 6, 2> by_principal_point = aligned.T_frame_keyframe.adjoint() *
                                                         principal_point_.stepByPrincipalPoint() *
                                                         principal_point_.belief().sigma().asDiagonal();
  return of_camera + by_principal_point * by_principal_point.transpose();
}

/// A principal point that is off, together with a lens that is not straight before the sensor, turns the
/// camera's axes, and no image shows such a turn: images tell only how far the principal point alone may be
/// off. The turn is the same in all poses. So in a chain of poses from keyframe to keyframe its errors add
/// up, and not their squares, as in the sum of these covariances: each has as many times its own share as a
/// second has keyframes.
Matrix6 SelfCalibration::covarianceByAxes(const SE3& T_frame_keyframe) const {
  const Matrix6 by_axes = Matrix6::Identity() - T_frame_keyframe.adjoint();
  const Eigen::Matrix<double, 6, 2> by_turn = by_axes.middleCols<2>(3);
  Eigen::Matrix2d turn_by_pixel;  // x turns about y
  turn_by_pixel << 0.0, -1.0 / given_.fy, 1.0 / given_.fx, 0.0;
  const Eigen::Matrix<double, 6, 2> by_pixel = by_turn * turn_by_pixel;
  return static_cast<double>(std::max<std::size_t>(keyframes_.size(), 1)) * by_pixel *
         principal_point_.belief().covarianceIfOff() * by_pixel.transpose();
}

PinholeCamera SelfCalibration::camera() const {
  PinholeCamera camera = given_;
  if (!learns_principal_point_) return camera;
  const Eigen::Vector2d correction = principal_point_.belief().correction();
  camera.cx += correction.x();
  camera.cy += correction.y();
  return camera;
}

bool SelfCalibration::contradicts(const KeyframeToTrack& keyframe) const {
  const PinholeCamera learned = camera();
  const double off = std::hypot(learned.cx - keyframe.camera.cx, learned.cy - keyframe.camera.cy);
  return off > kOtherPrincipalPoint * given_.fx;
}

void SelfCalibration::tell(TrackingResult& tracked) const {
  tracked.readout_time = shutter_.readoutTime();
  tracked.readout_sigma = shutter_.readoutSigma();
  if (learns_depth_delay_) tracked.depth_delay_sigma = depth_delay_.sigma();
  if (!learns_principal_point_) return;
  tracked.principal_point_correction = principal_point_.belief().correction();
  tracked.principal_point_sigma = principal_point_.belief().sigma();
}

std::string remarkOnCalibration(const TrackingResult& tracked) {
  const Eigen::Vector2d &off = tracked.principal_point_correction, &sigma = tracked.principal_point_sigma;
  if (off.isZero()) return "";
  const auto each = [](const Eigen::Vector2d& v) {
    return "(" + formatNumber(v.x(), 1) + ", " + formatNumber(v.y(), 1) + ") px";
  };
  return "the calibration looks off: the principal point is " + each(off) +
         " from that of camera_info, with a sigma of " + each(sigma) +
         ". Poses and stereo take this into account, while what is published keeps camera_info; calibrate "
         "the camera anew";
}

std::string remarkOnDepthDelay(const TrackingResult& tracked) {
  if (tracked.depth_delay == 0.0) return "";
  return "depth images are " + formatNumber(1e3 * std::abs(tracked.depth_delay), 1) +
         (tracked.depth_delay > 0.0 ? " ms older" : " ms younger") +
         " than their stamps say, with a sigma of " + formatNumber(1e3 * tracked.depth_delay_sigma, 1) +
         " ms. With compensate_skew, poses and fused depth take this into account";
}

}  // namespace rgbd_sfm_fusion
