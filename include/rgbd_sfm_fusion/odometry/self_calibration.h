// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <string>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/odometry/keyframe.h"
#include "rgbd_sfm_fusion/odometry/shutter.h"
#include "rgbd_sfm_fusion/odometry/tracking_result.h"
#include "rgbd_sfm_fusion/tracking/depth_delay_estimation.h"
#include "rgbd_sfm_fusion/tracking/principal_point_estimation.h"

namespace rgbd_sfm_fusion {

/// What tracking learns of the camera: its shutter, by how much the given principal point is off, and how
/// much older depth images are than their stamps say. A keyframe has one camera and one delay all its
/// life: the next keyframe takes what was learned.
class SelfCalibration {
 public:
  /// @param camera  as given
  SelfCalibration(const PinholeCamera& camera, const OdometryOptions& options);

  /// Forgets what was learned.
  void reset(const OdometryOptions& options);

  /// Keeps what was learned, but for the readout time where the options set another one than before.
  void setOptions(const OdometryOptions& options);

  /// Learns from an aligned frame.
  /// @param problem  the problem that `aligned` is the result of
  /// @param step     to the frame, from the frame before; unknown after a loss
  void observe(const AlignmentProblem& problem, const AlignmentResult& aligned,
               const KeyframeToTrack& keyframe, const Step& step);

  /// What the camera's own uncertainty adds to the covariance of an aligned pose: that of the shutter, and
  /// that of the camera's axes; once the principal point was corrected also that of the correction, for the
  /// pose that was observed last.
  /// @param step  to the frame, from the frame before; unknown after a loss
  Matrix6 covariance(const AlignmentResult& aligned, const Place& keyframe, const Step& step) const;

  /// The camera for the next keyframe.
  PinholeCamera camera() const;

  /// [s] of depth images, for the next keyframe; 0 while there is no clear sign of any.
  double depthDelay() const { return learns_depth_delay_ ? depth_delay_.delay() : 0.0; }

  /// Whether the keyframe has a principal point that turned out to be wrong. Its stereo is a per cent off,
  /// and stays so, as tracking and stereo confirm each other. A readout time that was not known yet is
  /// no reason: later views outweigh the stereo from before.
  bool contradicts(const KeyframeToTrack& keyframe) const;

  /// Says what was learned.
  void tell(TrackingResult& tracked) const;

 private:
  Matrix6 covarianceByAxes(const SE3& T_frame_keyframe) const;

  PinholeCamera given_;
  bool learns_readout_ = false, learns_principal_point_ = false, learns_depth_delay_ = false;
  Shutter shutter_;
  PrincipalPointEstimator principal_point_;
  DepthDelayEstimator depth_delay_;
  std::deque<Stamp> keyframes_;  // of the last second, up to the present one
};

/// A sentence for the user if it is clear that the calibration is off, with the numbers and the cure; empty
/// otherwise.
std::string remarkOnCalibration(const TrackingResult& tracked);

/// A sentence for the user if it is clear that depth images are older, or younger, than their stamps say;
/// empty otherwise.
std::string remarkOnDepthDelay(const TrackingResult& tracked);

}  // namespace rgbd_sfm_fusion
